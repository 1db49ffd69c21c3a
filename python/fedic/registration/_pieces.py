"""Partition of a loop of nodes into straight pieces and circular arcs."""

from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats

__all__ = ["Circle", "Piece", "cut_loop", "fit_circle"]

_TOLERANCE = 2e-4
"""Largest distance of nodes from their line or circle, relative to the size of the mesh."""
_CORNER = np.deg2rad(25.0)
_SMALLEST_SWEEP = np.deg2rad(20.0)
_FEWEST_ON_ARC = 5
_FEWEST_ON_CIRCLE = 8

Range: TypeAlias = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Circle:
    """A circle in the plane of the mesh.

    Attributes
    ----------
    centre : ndarray, shape (2,)
    radius : float
    """

    centre: Floats
    radius: float


@dataclass(frozen=True, eq=False)
class Piece:
    """Consecutive segments of a loop on one line or one circle.

    Attributes
    ----------
    segments : ndarray of int, shape (n, 3)
        Segments, see `fedic.registration._boundary.Loop`.
    circle : Circle, optional
        Circle of an arc; None for a straight piece.
    closed : bool
        True if the piece is the whole loop.
    """

    segments: NDArray[np.int64]
    circle: Circle | None
    closed: bool = False


def cut_loop(segments: NDArray[np.int64], points: Floats, size: float) -> list[Piece]:
    """Cut a loop into the longest lines and arcs, one after the other.

    Parameters
    ----------
    segments : ndarray of int, shape (n, 3)
        Segments of the loop.
    points : ndarray, shape (m, 3)
        Nodes of the mesh.
    size : float
        Size of the mesh, to which the tolerances are relative.

    Returns
    -------
    list of Piece
        Pieces in the order of the loop; a whole circle is one piece.
    """
    plane = points[:, :2]
    turns = _turns(segments, plane)
    circle = fit_circle(plane[_nodes(segments)])
    if (
        circle is not None
        and len(segments) >= _FEWEST_ON_CIRCLE
        and _off_circle(circle, plane[_nodes(segments)]) <= max(_TOLERANCE * size, 1e-3 * circle.radius)
        and np.abs(turns).max() < 4.0 * np.pi / len(segments)
    ):
        return [Piece(segments, circle, closed=True)]
    first = int(np.argmax(np.abs(turns)))
    segments, turns = np.roll(segments, -first, axis=0), np.roll(turns, -first)
    corners = [0, *(np.flatnonzero(np.abs(turns[1:]) > _CORNER) + 1), len(segments)]
    pieces: list[Piece] = []
    for start, end in pairwise(corners):
        while start < end:
            piece = _longest(segments[start:end], plane, _TOLERANCE * size)
            pieces.append(piece)
            start += len(piece.segments)
    return pieces


def fit_circle(plane: Floats) -> Circle | None:
    """Fit a circle to points (n, 2) by linear least squares; None where they lie on a line."""
    centre = plane.mean(axis=0)
    scale = float(np.abs(plane - centre).max())
    if len(plane) < 3 or scale == 0.0:
        return None
    x = (plane - centre) / scale
    rows = np.column_stack([2.0 * x, np.ones(len(x))])
    solution, _, rank, _ = np.linalg.lstsq(rows, (x**2).sum(axis=1), rcond=1e-9)
    if rank < 3:
        return None
    radius = float(np.sqrt(solution[2] + (solution[:2] ** 2).sum()))
    return Circle(centre + scale * solution[:2], scale * radius)


def _turns(segments: NDArray[np.int64], plane: Floats) -> Floats:
    """Return the angle by which the loop turns at the start of each segment."""
    chords = plane[segments[:, 2]] - plane[segments[:, 0]]
    before = np.roll(chords, 1, axis=0)
    cross = before[:, 0] * chords[:, 1] - before[:, 1] * chords[:, 0]
    angles: Floats = np.arctan2(cross, (before * chords).sum(axis=1))
    return angles


def _nodes(segments: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the nodes of segments, without missing middles."""
    nodes = segments.ravel()
    return nodes[nodes >= 0]


def _off_circle(circle: Circle, plane: Floats) -> float:
    return float(np.abs(np.linalg.norm(plane - circle.centre, axis=1) - circle.radius).max())


def _longest(segments: NDArray[np.int64], plane: Floats, tolerance: float) -> Piece:
    """Return the longest straight piece at the beginning, or the longest arc if that is longer."""

    def straight(count: int) -> bool:
        start, end = plane[segments[[0, count - 1], [0, 2]]]
        along = (end - start) / max(float(np.linalg.norm(end - start)), np.finfo(float).tiny)
        offsets = plane[_nodes(segments[:count])] - start
        return bool(np.abs(offsets[:, 0] * along[1] - offsets[:, 1] * along[0]).max() <= tolerance)

    def arc(count: int) -> Circle | None:
        nodes = plane[_nodes(segments[:count])]
        circle = fit_circle(nodes) if len(nodes) >= _FEWEST_ON_ARC else None
        return circle if circle is not None and _off_circle(circle, nodes) <= tolerance else None

    line = max((count for count in range(1, len(segments) + 1) if straight(count)), default=1)
    for count in range(len(segments), line, -1):
        circle = arc(count)
        if circle is not None:
            length = np.linalg.norm(plane[segments[:count, 2]] - plane[segments[:count, 0]], axis=1).sum()
            if length / circle.radius >= _SMALLEST_SWEEP:
                return Piece(segments[:count], circle)
    return Piece(segments[:line], None)
