"""Correlation of the residuals of neighbouring points, by which errors of the model make the points count less."""

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats

__all__ = ["correlation_factor"]

_NEIGHBOUR = 1.2
_MOST_POINTS = 1500
_LARGEST = 0.95


def correlation_factor(points: list[Floats], residuals: list[Floats]) -> float:
    """Return the factor by which correlated residuals enlarge a variance.

    The correlation ``r`` of the residuals of neighbouring points is measured. If it falls off as ``r**(|i| + |j|)``
    over columns and rows, ``n`` points count as many as ``n ((1 - r) / (1 + r))**2`` independent ones.

    Parameters
    ----------
    points : list of ndarray, shape (n, 3)
        Points of the target that are used in each view.
    residuals : list of ndarray, shape (n, 2)
        Their residuals.

    Returns
    -------
    float
        At least one, at most the number of points of a view.
    """
    products, squares, count = 0.0, 0.0, 0
    for places, values in zip(points, residuals, strict=True):
        first, second = _neighbours(places[:_MOST_POINTS])
        products += float((values[first] * values[second]).sum())
        squares += float((values[first] ** 2).sum())
        count += len(places)
    if squares == 0.0:
        return 1.0
    correlation = min(max(products / squares, 0.0), _LARGEST)
    return float(min(((1.0 + correlation) / (1.0 - correlation)) ** 2, max(count / len(points), 1.0)))


def _neighbours(places: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the indices of the pairs of points that are hardly further apart than the nearest ones, in both orders."""
    squares: Floats = sum(np.subtract.outer(along, along) ** 2 for along in places[:, :2].T)  # the target is flat
    np.fill_diagonal(squares, np.inf)
    reach = _NEIGHBOUR * np.median(np.sqrt(squares.min(axis=1)))
    first, second = np.nonzero(squares <= reach**2)
    return first, second
