"""Boundary of a mesh as closed loops of nodes, the material on the left."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES, Mesh
from fedic._internal.types import Floats
from fedic.registration._space import in_space

__all__ = ["Loop", "boundary_loops"]


@dataclass(frozen=True, eq=False)
class Loop:
    """A closed part of the boundary.

    Attributes
    ----------
    segments : ndarray of int, shape (n, 3)
        Nodes of each edge of a cell in order: first, middle (-1 where the edge is straight), last.
    area : float
        Area enclosed by the corner nodes; negative for the boundary of a hole.
    """

    segments: NDArray[np.int64]
    area: float


def boundary_loops(mesh: Mesh) -> list[Loop]:
    """Find the loops of the boundary.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    list of Loop
        Outer loops before holes, each sorted by position.
    """
    points = in_space(mesh.points)
    loops = []
    for chain in _chains(_boundary_segments(mesh)):
        x, y = points[chain[:, 0], :2].T
        area = 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
        loops.append((area < 0.0, _position(mesh, points[chain[:, 0], :2].mean(axis=0)), Loop(chain, area)))
    return [loop for _, _, loop in sorted(loops, key=lambda each: each[:2])]


def _position(mesh: Mesh, point: Floats) -> tuple[float, float]:
    """Return a sorting key, left to right and then bottom to top, insensitive to rounding."""
    size = float(np.ptp(mesh.points[mesh.used_nodes], axis=0).max())
    x, y = np.round(point / size, 4)
    return float(x), float(y)


def _boundary_segments(mesh: Mesh) -> NDArray[np.int64]:
    """Return the edges that belong to a single cell, shape (n, 3), in the direction of the cell."""
    parts = []
    for name, outline in zip(mesh.cells, mesh.outlines(), strict=True):
        # An edge with more than one inner node counts as straight segments between its nodes.
        step = 2 if CELL_TYPES[name].edge_intervals == 2 else 1
        first, last = outline[:, ::step], np.roll(outline, -step, axis=1)[:, ::step]
        middle = outline[:, 1::2] if step == 2 else np.full_like(first, -1)
        parts.append(np.stack([first, middle, last], axis=-1).reshape(-1, 3))
    segments = np.concatenate(parts)
    ends = np.sort(segments[:, [0, 2]], axis=1)
    _, which, counts = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    alone: NDArray[np.int64] = segments[counts[which.ravel()] == 1]
    return alone


def _chains(segments: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Join segments into closed chains."""
    following: dict[int, list[int]] = {}
    for index in np.argsort(segments[:, 0], kind="stable")[::-1]:
        following.setdefault(int(segments[index, 0]), []).append(int(index))
    chains = []
    for first in sorted(following):
        while following[first]:
            chain = [following[first].pop()]
            while (node := int(segments[chain[-1], 2])) != first and following.get(node):
                chain.append(following[node].pop())
            chains.append(segments[chain])
    return chains
