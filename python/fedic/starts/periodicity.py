"""Detection of periodic textures, such as printed grids, by several near-equal maxima of a correlation."""

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.starts.images import StartImages
from fedic.starts.template import correlation_map

__all__ = ["other_maxima", "repeats"]

_NEAR_EQUAL = 0.9
_VALLEY = 0.7
"""Share of the largest correlation below which it falls between two maxima."""
_NEAR_ITSELF = 0.8
_SMALLEST_WINDOW = 8
_MOST = 8
_SIDE = 1024.0


def other_maxima(scores: NDArray[np.float32], share: float = _NEAR_EQUAL) -> Floats:
    """Find the maxima of a correlation that are nearly as large as the largest.

    Parameters
    ----------
    scores : ndarray of float32, shape (height, width)
        Correlation coefficients at all shifts.
    share : float
        Smallest ratio to the largest one.

    Returns
    -------
    ndarray of float64, shape (k, 2)
        Distances (u, v) from the largest maximum to at most eight others, nearest first.
    """
    import cv2

    highest = float(scores.max())
    if highest <= 0.0:
        return np.empty((0, 2))
    _, labels = cv2.connectedComponents((scores >= _VALLEY * highest).astype(np.uint8))
    order = np.argsort(scores, axis=None)[::-1]
    order = order[: np.count_nonzero(scores >= share * highest)]
    _, first = np.unique(np.asarray(labels).ravel()[order], return_index=True)
    places = np.stack(np.unravel_index(order[np.sort(first)], scores.shape)[::-1], axis=-1).astype(np.float64)
    distances = places[1:] - places[0]
    found: Floats = distances[np.argsort(np.linalg.norm(distances, axis=1), kind="stable")][:_MOST]
    return found


def repeats(images: StartImages) -> Floats:
    """Find the translations at which the texture under the mesh resembles itself.

    A measurement can be wrong by any of them. Their number and direction do not depend on the motion.

    Parameters
    ----------
    images : StartImages
        The two images and the region of the mesh.

    Returns
    -------
    ndarray of float64, shape (k, 2)
        At most eight translations (u, v) in pixels of the reference image, shortest first; none if it is not periodic.
    """
    if not images.has_texture():
        return np.empty((0, 2))
    level = images.level_of_side(_SIDE)
    low, high = level.bounds()
    quarter = (high + 1 - low) // 4
    if (quarter * 2 < _SMALLEST_WINDOW).any():
        return np.empty((0, 2))
    whole = level.reference[low[1] : high[1] + 1, low[0] : high[0] + 1]
    scores = correlation_map(whole, whole[quarter[1] : 3 * quarter[1], quarter[0] : 3 * quarter[0]])
    return other_maxima(scores, _NEAR_ITSELF) / np.diag(level.reduction)[:2]
