"""Quick test for periodic textures: the autocorrelation of one window of the reference image."""

import numpy as np

from fedic._internal.types import Floats, Image

__all__ = ["may_repeat"]

_SMALLEST_WINDOW = 8
_SIDE = 128
_SCORE = 0.45
"""Autocorrelation from which on a texture may be periodic."""
_CENTRES = 3
_NODES = 2000


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
    side = np.minimum(high - low, _SIDE)
    if not np.isfinite(side).all() or (side < _SMALLEST_WINDOW).any():
        return False
    corners = [low + share * (high - low - side) for share in np.linspace(0.0, 1.0, _CENTRES)]
    starts = [np.array([column[0], row[1]]) for column in corners for row in corners]
    # The window with most nodes: a mesh may have holes.
    some = nodes[:: max(1, len(nodes) // _NODES)]
    start = max(starts, key=lambda at: int(((some >= at) & (some <= at + side)).all(axis=1).sum()))
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
    radius = distance[scores < 0.5 * _SCORE].min(initial=np.inf)
    return bool((scores[distance > 2.0 * radius] > _SCORE).any())
