"""Squares of pixels that are left out of a measurement, and read afterwards."""

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats

__all__ = ["MOST_PATTERNS", "SIDE", "left_out", "square_sums"]

SIDE = 7
"""Side of a square in pixels."""
_STEP = 3
"""Distance of the squares left out together, in squares."""
_MARGIN = 1
"""Pixels along the border of a square that are left out but not read: noise reaches across it by smoothing."""
_ORDER = (0, 4, 8, 2, 3, 7, 1, 5, 6)
"""Order of the patterns: the first ones are spread evenly."""
MOST_PATTERNS = len(_ORDER)


def left_out(shape: tuple[int, ...], pattern: int) -> NDArray[np.bool_]:
    """Return the pixels that a pattern leaves out, each pixel being left out by one pattern."""
    row, column = divmod(_ORDER[pattern], _STEP)
    rows, columns = (np.arange(size) // SIDE % _STEP for size in shape)
    left: NDArray[np.bool_] = (rows == row)[:, None] & (columns == column)
    return left


def square_sums(residual: NDArray[np.float32], pattern: int) -> tuple[Floats, Floats]:
    """Return the number of pixels read in each square and the sum of their squared residuals; NaN is not read."""
    places = [np.arange(size) % SIDE for size in residual.shape]
    rows, columns = ((place >= _MARGIN) & (place < SIDE - _MARGIN) for place in places)
    read = left_out(residual.shape, pattern) & rows[:, None] & columns & np.isfinite(residual)
    v, u = np.nonzero(read)
    height, width = (size // SIDE + 1 for size in residual.shape)
    squares = v // SIDE * width + u // SIDE
    weights = np.array([np.ones(len(v)), residual[read].astype(np.float64) ** 2])
    counts, sums = (np.bincount(squares, weight, minlength=height * width).astype(np.float64) for weight in weights)
    return counts, sums
