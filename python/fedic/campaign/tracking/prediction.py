"""The displacement of the next frame, extrapolated from earlier ones."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats

__all__ = ["KnownFrame", "extrapolated", "filled"]

_SWEEPS = 50
"""Averages over the neighbours that smooth what is filled."""
_FARTHEST = 2.0
"""Largest step of an extrapolation, in steps between the two frames that it is made from."""


@dataclass(frozen=True, eq=False)
class KnownFrame:
    """A frame that later ones start from.

    Attributes
    ----------
    index : int
        Its number in the series; -1 for the reference.
    displacement : ndarray of float64, shape (n, 2)
        Nodal displacements, filled where they were not measured.
    residual_rms : float
        Its residual, in grey levels.
    flagged_share : float
        Share of its cells that are flagged.
    """

    index: int
    displacement: Floats
    residual_rms: float
    flagged_share: float


def extrapolated(frames: Sequence[KnownFrame], index: int) -> Floats:
    """Extrapolate the displacement linearly from the last two frames that are known.

    Parameters
    ----------
    frames : sequence of KnownFrame
        One or more, in their order.
    index : int
        Number of the frame that is to be measured.

    Returns
    -------
    ndarray of float64, shape (n, 2)
        Its displacement if the motion goes on as between the two; that of the last frame if there is one only.
    """
    last = frames[-1]
    if len(frames) < 2:
        return last.displacement
    before = frames[-2]
    steps = min((index - last.index) / (last.index - before.index), _FARTHEST)
    return last.displacement + steps * (last.displacement - before.displacement)


def filled(mesh: Mesh, displacement: Floats) -> Floats:
    """Fill a displacement smoothly at the nodes where it was not measured.

    The affine motion of the measured nodes is continued, and what they deviate from it is spread to the others, from
    neighbour to neighbour.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    displacement : ndarray of float64, shape (n, 2)
        Nodal displacements; NaN where they were not measured.

    Returns
    -------
    ndarray of float64, shape (n, 2)
        The same where measured, and finite everywhere; zero at nodes of no cell and if nothing was measured.
    """
    known = np.asarray(np.isfinite(displacement).all(axis=1))
    complete = np.where(known[:, np.newaxis], displacement, 0.0)
    if known.all() or not known.any():
        return complete
    motion = _affine_motion(mesh.points, displacement, known)
    rest = np.where(known[:, np.newaxis], complete - motion, 0.0)
    complete = np.where(known[:, np.newaxis], complete, motion + _spread(mesh, rest, known))
    complete[~mesh.used_nodes] = 0.0
    return complete


def _affine_motion(points: Floats, displacement: Floats, known: NDArray[np.bool_]) -> Floats:
    """Fit an affine field to the known nodes; a translation if there are too few."""
    places = points - points[known].mean(axis=0)
    terms: Floats = np.column_stack([np.ones(len(points)), places])
    # Of a plane or of few points some directions are not determined: the solution of least norm leaves them out.
    coefficients, *_ = np.linalg.lstsq(terms[known], displacement[known], rcond=1e-9)
    return np.asarray(terms @ coefficients)


def _spread(mesh: Mesh, values: Floats, known: NDArray[np.bool_]) -> Floats:
    """Spread values to the nodes where they are not known: from neighbour to neighbour, then smoothed."""
    first, second = _neighbours(mesh)
    spread: Floats = values.copy()
    reached = known.copy()
    while True:
        means, counts = _means(spread, first[reached[second]], second[reached[second]])
        new = ~reached & (counts > 0)
        if not new.any():
            break
        spread[new] = means[new]
        reached |= new
    free = reached & ~known
    for _ in range(_SWEEPS):
        means, _ = _means(spread, first, second)
        spread[free] = means[free]
    return spread


def _means(values: Floats, first: NDArray[np.int64], second: NDArray[np.int64]) -> tuple[Floats, NDArray[np.int64]]:
    """Return the mean of the values at the neighbours of each node, and their number."""
    counts = np.bincount(first, minlength=len(values))
    sums = np.stack([np.bincount(first, weights=column[second], minlength=len(values)) for column in values.T], axis=1)
    return sums / np.maximum(counts, 1)[:, np.newaxis], counts


def _neighbours(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return all pairs of nodes that share a cell, both ways."""
    pairs = []
    for nodes in mesh.cells.values():
        for shift in range(1, nodes.shape[1]):
            pairs.append(np.stack([nodes, np.roll(nodes, shift, axis=1)], axis=-1).reshape(-1, 2))
    together = np.concatenate(pairs)
    return together[:, 0], together[:, 1]
