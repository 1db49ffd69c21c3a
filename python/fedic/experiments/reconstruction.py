"""Fields reconstructed from the nodes of a fine regular mesh of four-noded cells, by generalised least squares.

The information matrix of the nodes is the correlation matrix of the fine mesh. For a uniform texture it is the
consistent mass matrix for both components, on a regular grid the product of two one-dimensional matrices. The coarse
spaces are products of one-dimensional bases too, with or without the mixed terms of high degree.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.errors import SolveError
from fedic.experiments.mei import Field
from fedic.results import Result

__all__ = ["Space", "reconstruct"]

_CG_TOLERANCE, _CG_STEPS = 1e-8, 4000

_Basis: TypeAlias = tuple[Floats, NDArray[np.int64]]
"""Values at points (m, functions) and the degree of each function."""


@dataclass(frozen=True)
class Space:
    """A space of fields on coarse square elements.

    Attributes
    ----------
    kind : {"tensor", "serendipity", "spline"}
        Continuous polynomials with all products of their degree; without products of interior functions of higher total
        degree; cubic splines.
    degree : int
        Degree along an edge; splines are cubic.
    ratio : int
        Number of fine elements along the edge of a coarse one.
    """

    kind: Literal["tensor", "serendipity", "spline"]
    degree: int
    ratio: int

    def basis(self, knots: Floats, points: Floats) -> _Basis:
        """Evaluate the one-dimensional functions between `knots` at `points`."""
        return _splines(knots, points) if self.kind == "spline" else _hierarchical(knots, self.degree, points)

    def keeps(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return a mask of the products of functions of these degrees that belong to the space."""
        vertical, horizontal = rows[:, np.newaxis], columns[np.newaxis, :]
        if self.kind != "serendipity":
            return np.ones((len(rows), len(columns)), dtype=np.bool_)
        return (vertical < 2) | (horizontal < 2) | (vertical + horizontal <= self.degree)


def reconstruct(result: Result, size: float, space: Space) -> tuple[Field, float]:
    """Project the nodal values of a fine regular mesh on a coarser space.

    Parameters
    ----------
    result : Result
        Result on a regular mesh of ``quad`` cells in pixels, with an even number of rows.
    size : float
        Edge of the cells, in pixels.
    space : Space
        The coarse space; its elements have a line of nodes on the middle row.

    Returns
    -------
    field : callable
        The reconstructed field.
    reach : float
        Extent above and below the middle row, in pixels.
    """
    columns, rows, nodal = _as_grid(result)
    middle = len(rows) // 2
    kept = middle // space.ratio * space.ratio
    along = (len(columns) - 1) // space.ratio * space.ratio + 1
    rows, columns = rows[middle - kept : middle + kept + 1], columns[:along]
    nodal = nodal[middle - kept : middle + kept + 1, :along]
    row_knots, column_knots = rows[:: space.ratio], columns[:: space.ratio]
    coefficients = _reduce(nodal, size, space.basis(row_knots, rows), space.basis(column_knots, columns), space)

    def field(x: Floats, y: Floats) -> Floats:
        vertical, horizontal = space.basis(row_knots, y)[0], space.basis(column_knots, x)[0]
        return np.stack([vertical @ part @ horizontal.T for part in coefficients], axis=-1)

    return field, float(rows[-1] - rows[0]) / 2.0


def _as_grid(result: Result) -> tuple[Floats, Floats, Floats]:
    """Return columns (m,), rows (n,) and displacements (n, m, 2) of the nodes."""
    points = result.mesh.points
    columns, column = np.unique(points[:, 0].round(6), return_inverse=True)
    rows, row = np.unique(points[:, 1].round(6), return_inverse=True)
    nodal = np.empty((len(rows), len(columns), 2))
    nodal[row, column] = result.unchecked_displacement
    return columns, rows, nodal


def _reduce(nodal: Floats, size: float, rows: _Basis, columns: _Basis, space: Space) -> list[Floats]:
    """Return the coefficients of both components."""
    (vertical, row_degrees), (horizontal, column_degrees) = rows, columns
    kept = space.keeps(row_degrees, column_degrees)
    by_row, by_column = (basis.T @ _mass(len(basis), size) for basis in (vertical, horizontal))
    gram_rows, gram_columns = by_row @ vertical, by_column @ horizontal
    parts = [by_row @ nodal[..., axis] @ by_column.T for axis in (0, 1)]
    if kept.all():
        return [np.linalg.solve(gram_rows, np.linalg.solve(gram_columns, part.T).T) for part in parts]

    def apply(coefficients: Floats) -> Floats:
        return np.where(kept, gram_rows @ coefficients @ gram_columns, 0.0)

    diagonal = np.outer(np.diag(gram_rows), np.diag(gram_columns))
    return [_conjugate_gradients(apply, np.where(kept, part, 0.0), diagonal) for part in parts]


def _conjugate_gradients(apply: Callable[[Floats], Floats], right: Floats, diagonal: Floats) -> Floats:
    found, residual = np.zeros_like(right), right
    scaled = residual / diagonal
    direction, energy = scaled, float((residual * scaled).sum())
    goal = _CG_TOLERANCE**2 * energy
    for _ in range(_CG_STEPS):
        if energy <= goal:
            return found
        image = apply(direction)
        step = energy / float((direction * image).sum())
        found, residual = found + step * direction, residual - step * image
        scaled = residual / diagonal
        energy, previous = float((residual * scaled).sum()), energy
        direction = scaled + energy / previous * direction
    raise SolveError(f"The projection of the nodal field did not converge within {_CG_STEPS} conjugate-gradient steps.")


def _mass(count: int, size: float) -> Floats:
    """Return the consistent mass matrix of a row of two-noded elements."""
    mass = np.diag(np.full(count, 4.0)) + np.diag(np.ones(count - 1), 1) + np.diag(np.ones(count - 1), -1)
    mass[0, 0] = mass[-1, -1] = 2.0
    return mass * size / 6.0


def _place(knots: Floats, points: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Return the element of each point and its coordinate there, from 0 to 1."""
    where = (points - knots[0]) / (knots[1] - knots[0])
    element = np.clip(np.floor(where + 1e-9).astype(np.int64), 0, len(knots) - 2)
    return element, where - element


def _hierarchical(knots: Floats, degree: int, points: Floats) -> _Basis:
    """Evaluate the hat functions of the knots, then the integrated Legendre polynomials of each element."""
    element, place = _place(knots, points)
    at, elements = np.arange(len(points)), len(knots) - 1
    values = np.zeros((len(points), len(knots) + elements * (degree - 1)))
    values[at, element] = 1.0 - place
    values[at, element + 1] = place
    legendre = np.polynomial.legendre.Legendre.basis
    for order in range(2, degree + 1):
        mode = (legendre(order) - legendre(order - 2))(2.0 * place - 1.0)
        values[at, len(knots) + elements * (order - 2) + element] = mode
    degrees = np.concatenate([np.ones(len(knots)), np.repeat(np.arange(2, degree + 1), elements)])
    return values, degrees.astype(np.int64)


def _splines(knots: Floats, points: Floats) -> _Basis:
    """Evaluate uniform cubic B-splines."""
    element, t = _place(knots, points)
    values = np.zeros((len(points), len(knots) + 2))
    pieces = ((1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3)
    for offset, piece in enumerate(pieces):
        values[np.arange(len(points)), element + offset] = piece / 6.0
    return values, np.full(values.shape[1], 3)
