"""Doubts about a fit: features whose edge lies to one side of them all along."""

from collections.abc import Iterable

import numpy as np

from fedic.registration._result import FeatureDistances

__all__ = ["doubts_of"]

_LARGEST_PX = 1.0
"""Median distance that is doubtful whatever the scatter."""
_ONE_SIDED_PX, _ONE_SIDED = 0.5, 0.95
"""Median distance that is doubtful if this fraction of the segments lies to the same side."""


def doubts_of(features: Iterable[FeatureDistances]) -> list[str]:
    """Return a sentence for each feature whose edge lies to one side of it.

    The noise of speckles is different in each segment and moves the edge to either side. A mean distance that stays is
    a difference of shape or size, or a wrong pose.

    Parameters
    ----------
    features : iterable of FeatureDistances
        Distances of the fit.

    Returns
    -------
    list of str
        The sentences.
    """
    sentences = []
    for found in features:
        distances = found.distances[found.used]
        median = float(np.median(distances))
        same = max(float((distances > 0.0).mean()), float((distances < 0.0).mean()))
        if abs(median) > _LARGEST_PX or (abs(median) > _ONE_SIDED_PX and same >= _ONE_SIDED):
            side = "out of" if median > 0.0 else "inside"
            sentences.append(
                f"The edge of the feature {found.name!r} in the image lies {side} the material of the mesh, by "
                f"{abs(median):.1f} px in the median and to this side in {same:.0%} of its segments: the specimen "
                "differs from the mesh there, the mesh lies the wrong way round, or the pose is wrong."
            )
    return sentences
