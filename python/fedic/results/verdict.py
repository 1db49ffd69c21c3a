"""The verdict on a solution, and the warnings about it."""

import warnings

import numpy as np

from fedic import _core
from fedic._core import NODE_FLAGS, Mesh
from fedic._internal.types import Floats, Image
from fedic._internal.warning_level import levels_within_fedic
from fedic.errors import ConvergenceWarning, QualityWarning
from fedic.results.quality import Quality
from fedic.results.result import Result

__all__ = ["quality_of", "warn_of_quality"]

_SATURATED_SHARE = 0.01
"""Share of saturated pixels from which on a warning is given."""


def quality_of(
    correlator: _core.Correlator, solution: _core.Solution, images: tuple[Image, Image], mesh: Mesh, repeats: Floats
) -> Quality:
    """Collect the evidence about a solution.

    Parameters
    ----------
    correlator : Correlator of the core
        It has made the solution.
    solution : Solution of the core
        The solution.
    images : (ndarray, ndarray), shape (height, width)
        The reference and the deformed image.
    mesh : Mesh
        The mesh.
    repeats : ndarray, shape (k, 2)
        Translations at which the texture of the reference image resembles itself.

    Returns
    -------
    Quality
        The verdict.
    """
    reference, deformed = images
    used = mesh.used_nodes
    nodes = correlator.node_pixels()[used]
    moved = nodes + np.nan_to_num(solution.pixel_displacement[used])
    node_flags = solution.node_flags
    if len(repeats):
        node_flags |= np.uint8(1 << list(NODE_FLAGS).index("periodic"))
    return Quality(
        noise=solution.noise,
        **solution.cell_evidence,
        standard_deviation=solution.node_evidence["deviation"],
        conditioning=solution.node_evidence["conditioning"],
        repeats=repeats,
        saturated_share=(
            _saturated_share(correlator, reference, nodes),
            _saturated_share(correlator, deformed, moved),
        ),
        converged=solution.converged,
        cell_flags=solution.cell_flags,
        node_flags=node_flags,
    )


def warn_of_quality(result: Result) -> None:
    """Warn if the verdict on a result is that something is doubtful, or many pixels are saturated.

    Parameters
    ----------
    result : Result
        The result.
    """
    quality = result.quality
    if not quality.is_good:
        reasons = "; ".join(quality.reasons())
        if result.converged:
            warnings.warn(f"the result is doubtful: {reasons}", QualityWarning, stacklevel=levels_within_fedic())
        else:
            tried = f" Starts tried: {'; '.join(map(str, result.attempts))}." if result.attempts else ""
            warnings.warn(
                f"{reasons}. The largest error left is about {result.error_left:.2g} px.{tried} Check that both images "
                "show the same specimen, or give an initial displacement per node.",
                ConvergenceWarning,
                stacklevel=levels_within_fedic(),
            )
    for image, share in zip(("reference", "deformed"), quality.saturated_share, strict=True):
        if share >= _SATURATED_SHARE:
            warnings.warn(
                f"{share:.1%} of the pixels of the {image} image around the mesh are saturated; their texture is lost: "
                "shorten the exposure",
                QualityWarning,
                stacklevel=levels_within_fedic(),
            )


def _saturated_share(correlator: _core.Correlator, image: Image, pixels: Floats) -> float:
    """Return the share of saturated pixels in the box around some image points."""
    known = pixels[np.isfinite(pixels).all(axis=1)]
    if not len(known):
        return 0.0
    limit = max(image.shape)
    low, high = (np.clip(bound, 0, limit) for bound in (np.floor(known.min(axis=0)), np.ceil(known.max(axis=0)) + 1))
    return correlator.saturated_share(image, (int(low[0]), int(low[1])), (int(high[0]), int(high[1])))
