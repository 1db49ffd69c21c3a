"""Corners of squares, from a model of the grey levels around them in the plane of the target.

Once an approximate camera is known, the pixels around a corner are unprojected to the plane of the target, where the
edges are parallel to the axes. The grey level there is ``a + b e((X - X0) / w) e((Y - Y0) / w)``, with ``e`` the error
function of an edge blurred over ``w``; Gauss-Newton estimates the corner ``(X0, Y0)`` together with ``a``, ``b`` and
``w``. The true blur, by the aperture of a pixel seen at an angle, is symmetric about the corner like the model.
"""

import numpy as np

from fedic._internal.types import Floats
from fedic.calibration.target import Target

__all__ = ["corner_in_plane", "corner_reach"]

_REACH = 0.45
_FARTHEST = 25.0
"""Half the side of the largest square used, in pixels: further out, uneven lighting matters more than the edges."""
_STEPS = 20
_TOLERANCE = 1e-4


def corner_reach(target: Target) -> float:
    """Return half the side of the square around a corner that is free of other edges, markers included."""
    pitch = min(target.pitches)
    return pitch * _REACH if target.kind == "chessboard" else 0.5 * (pitch - target.marker)


def corner_in_plane(points: Floats, levels: Floats, start: Floats, reach: float, pixel: float) -> Floats:
    """Return the corner near a start.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Pixels around the corner, unprojected to the plane of the target.
    levels : ndarray, shape (n,)
        Their grey levels.
    start : ndarray, shape (2,)
        Approximate corner.
    reach : float
        Half the side of the square that is free of other edges.
    pixel : float
        Size of a pixel in the plane.

    Returns
    -------
    ndarray, shape (2,)
        The corner; NaN if there is none.
    """
    reach = min(reach - pixel, _FARTHEST * pixel)
    near = (np.abs(points - start) < reach).all(axis=1)
    points, levels = points[near], levels[near]
    missing = np.full(2, np.nan)
    if len(levels) < 12:
        return missing
    corner: Floats = start
    width = 0.7 * pixel
    quadrants = np.sign(points - start).prod(axis=1)
    half = 0.5 * float(levels[quadrants > 0].mean() - levels[quadrants < 0].mean())
    middle = float(levels.mean())
    for _ in range(_STEPS):
        offsets = (points - corner) / width
        edges, slopes = _edge(offsets)
        product = edges.prod(axis=1)
        across = half * slopes * edges[:, ::-1] / width
        columns = np.column_stack([-across, np.ones_like(product), product, -(across * offsets).sum(axis=1)])
        step, *_ = np.linalg.lstsq(columns, levels - middle - half * product, rcond=None)
        corner, middle, half = corner + step[:2], middle + step[2], half + step[3]
        width = float(np.clip(width + step[4], 0.2 * pixel, reach))
        if np.abs(corner - start).max() > 0.5 * reach:
            return missing
        if np.abs(step[:2]).max() < _TOLERANCE * pixel:
            return corner
    return missing


def _edge(offsets: Floats) -> tuple[Floats, Floats]:
    """Return the error function, to 2e-7 (Abramowitz and Stegun, 7.1.26), and its derivative."""
    bell = np.exp(-(offsets**2))
    t = 1.0 / (1.0 + 0.3275911 * np.abs(offsets))
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))))
    return np.sign(offsets) * (1.0 - tail * bell), 2.0 / np.sqrt(np.pi) * bell
