"""All estimators in order of their cost, and the candidates of two images one after the other."""

from collections.abc import Iterator

from fedic.starts.candidate import Candidate, Estimator
from fedic.starts.features import matched_features
from fedic.starts.fft import translations
from fedic.starts.flow import dense_flow
from fedic.starts.images import StartImages
from fedic.starts.log_polar import turned

__all__ = ["ESTIMATORS", "candidates"]

ESTIMATORS: dict[str, Estimator] = {"fft": translations, "features": matched_features, "log-polar": turned}
"""The estimators of a motion of the whole mesh, cheapest first."""


def candidates(images: StartImages) -> Iterator[Candidate]:
    """Run the estimators one after the other, each when its candidates are asked for.

    ``"flow"`` is last: it adds what varies over the mesh to the best motion of the others.

    Parameters
    ----------
    images : StartImages
        The two images and the region of the mesh.

    Yields
    ------
    Candidate
        In the order of `ESTIMATORS`, then ``"flow"``; nothing where the images have no texture or nothing in common.
    """
    best = None
    for estimate in ESTIMATORS.values():
        for each in estimate(images):
            yield each
            if best is None or each.score * each.overlap > best.score * best.overlap:
                best = each
    yield from dense_flow(images, None if best is None else best.motion)
