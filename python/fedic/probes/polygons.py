"""Points and weights for the mean over a polygon."""

import numpy as np

from fedic._internal.types import Floats

__all__ = ["crossing_sides", "polygon_area", "polygon_pieces"]

_MOST_PIECES = 4_000
_FEWEST_ACROSS = 4
"""Smallest number of squares across the polygon in each direction."""


def polygon_area(corners: Floats) -> float:
    """Return the area of a polygon without crossings.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        The corners in order.

    Returns
    -------
    float
        The area.
    """
    return abs(_moments(corners - corners[0])[0])


def crossing_sides(corners: Floats) -> tuple[int, int] | None:
    """Find two sides of a polygon that cross.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        The corners in order; side ``i`` begins at corner ``i``.

    Returns
    -------
    tuple of int or None
        The first pair; None if there is none.
    """
    starts, ends = corners, np.roll(corners, -1, axis=0)

    def side_of(points: Floats) -> Floats:
        """Return on which side of each side of the polygon points lie, (sides, points)."""
        along, relative = (ends - starts)[:, np.newaxis], points - starts[:, np.newaxis]
        return np.sign(along[..., 0] * relative[..., 1] - along[..., 1] * relative[..., 0])

    apart = side_of(starts) * side_of(ends) < 0
    pairs = np.argwhere(np.triu(apart & apart.T))
    return (int(pairs[0, 0]), int(pairs[0, 1])) if len(pairs) else None


def polygon_pieces(corners: Floats, step: float) -> tuple[Floats, Floats]:
    """Cut a polygon by a grid of rectangles.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        The corners in order.
    step : float
        Largest side of the rectangles. They are larger where more than 4,000 would be needed, and smaller if fewer
        than 4 would lie across the polygon in a direction.

    Returns
    -------
    centres : ndarray, shape (m, 2)
        Centres of area of the pieces.
    areas : ndarray, shape (m,)
        Their areas. The weighted mean of a linear function is exact.
    """
    low, high = corners.min(axis=0), corners.max(axis=0)
    counts = np.maximum(np.ceil((high - low) / step), _FEWEST_ACROSS)
    counts = np.maximum(np.floor(counts / max(1.0, np.sqrt(counts.prod() / _MOST_PIECES))), _FEWEST_ACROSS)
    cuts = [np.linspace(low[axis], high[axis], int(counts[axis]) + 1) for axis in range(2)]
    centres, areas = [], []
    for column in _bands(corners, 0, cuts[0]):
        for piece in _bands(column, 1, cuts[1]):
            area, first = _moments(piece - piece[0])
            if area != 0.0:
                centres.append(piece[0] + first / area)
                areas.append(abs(area))
    return np.array(centres), np.array(areas)


def _bands(corners: Floats, axis: int, cuts: Floats) -> list[Floats]:
    """Return the parts of a polygon between neighbouring values of a coordinate."""
    bands = []
    rest = corners
    for cut in cuts[1:-1]:
        below, rest = _half(rest, axis, cut, -1.0), _half(rest, axis, cut, 1.0)
        bands.append(below)
    return [band for band in [*bands, rest] if len(band) > 2]


def _half(corners: Floats, axis: int, cut: float, sign: float) -> Floats:
    """Return the part of a polygon on one side of a line (I. Sutherland and G. Hodgman, Comm. ACM 17, 1974)."""
    distance = sign * (corners[:, axis] - cut)
    if (distance >= 0).all():
        return corners
    kept = []
    points, sides = corners.tolist(), distance.tolist()
    for here, (x, y) in enumerate(points, start=-len(points)):
        side, next_side, (next_x, next_y) = sides[here], sides[here + 1], points[here + 1]
        if side >= 0:
            kept.append((x, y))
        if side * next_side < 0:
            share = side / (side - next_side)
            kept.append((x + share * (next_x - x), y + share * (next_y - y)))
    return np.array(kept).reshape(-1, 2)


def _moments(corners: Floats) -> tuple[float, Floats]:
    """Return the signed area of a polygon and its first moments about the origin."""
    after = np.concatenate([corners[1:], corners[:1]])
    cross = corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]
    return float(0.5 * cross.sum()), ((corners + after) * cross[:, np.newaxis]).sum(axis=0) / 6.0
