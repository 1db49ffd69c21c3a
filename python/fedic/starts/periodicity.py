"""Detection of periodic textures, such as printed grids, by several near-equal maxima of a correlation."""

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats, Image
from fedic.starts.images import StartImages
from fedic.starts.template import correlation_map

__all__ = ["may_repeat", "other_maxima", "repeats"]

_NEAR_EQUAL = 0.9
_VALLEY = 0.7
"""Share of the largest correlation below which it falls between two maxima."""
_NEAR_ITSELF = 0.8
_SMALLEST_WINDOW = 8
_MOST = 8
_SIDE = 1024.0
_QUICK_SIDE = 256
_QUICK_SCORE = 0.45
"""Autocorrelation from which on a texture may be periodic."""
_CENTRES = 3


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


def may_repeat(reference: Image, nodes: Floats) -> bool:
    """Tell whether the texture under a mesh may be periodic, from the autocorrelation of one window.

    It costs some milliseconds, and `repeats` a hundred.

    Parameters
    ----------
    reference : ndarray, shape (height, width)
        The reference image.
    nodes : ndarray of float64, shape (n, 2)
        Nodes of the mesh in pixels.

    Returns
    -------
    bool
        False for a random texture.
    """
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    side = np.minimum(high - low, _QUICK_SIDE)
    if not np.isfinite(side).all() or (side < _SMALLEST_WINDOW).any():
        return False
    corners = [low + share * (high - low - side) for share in np.linspace(0.0, 1.0, _CENTRES)]
    starts = [np.array([column[0], row[1]]) for column in corners for row in corners]
    # The window with most nodes: a mesh may have holes.
    start = max(starts, key=lambda at: int(((nodes >= at) & (nodes <= at + side)).all(axis=1).sum()))
    first = np.maximum(np.rint(start).astype(int), 0)
    last = np.rint(start + side).astype(int)
    window = reference[first[1] : last[1], first[0] : last[0]].astype(np.float64)
    if min(window.shape) < _SMALLEST_WINDOW or np.ptp(window) == 0.0:
        return False
    window -= window.mean()
    shape = [2 * length for length in window.shape]
    spectrum = np.fft.rfft2(window, shape)
    products = np.fft.irfft2(spectrum * spectrum.conj(), shape)
    half_v, half_u = window.shape[0] // 2, window.shape[1] // 2
    # Lags of up to half the window, all rows and the right half: the autocorrelation is symmetric.
    scores = np.concatenate([products[-half_v:, :half_u], products[:half_v, :half_u]])
    rows = np.abs(np.arange(-half_v, half_v))[:, np.newaxis]
    overlap = (window.shape[0] - rows) * (window.shape[1] - np.arange(half_u))
    scores = scores / overlap / window.var()
    return _has_second_maximum(scores, (half_v, 0))


def _has_second_maximum(scores: Floats, centre: tuple[int, int]) -> bool:
    """Tell whether a correlation has a maximum apart from that at the centre."""
    rows, columns = np.arange(scores.shape[0])[:, np.newaxis], np.arange(scores.shape[1])
    distance = np.hypot(rows - centre[0], columns - centre[1])
    radius = distance[scores < 0.5 * _QUICK_SCORE].min(initial=np.inf)
    return bool((scores[distance > 2.0 * radius] > _QUICK_SCORE).any())
