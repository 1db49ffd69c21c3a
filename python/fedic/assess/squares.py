"""Fields averaged over squares of a fixed size."""

from dataclasses import dataclass

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.errors import OptionError
from fedic.results import Result

__all__ = ["SquareField", "average_over_squares", "square_samples"]

_SAMPLES = 10
"""Samples of a square along each side."""
_LEAST_SHARE = 0.5
"""Share of the samples of a square that must lie in the mesh, and of those in measured cells."""


@dataclass(frozen=True)
class SquareField:
    """One averaged value for each square that was measured.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Mean position of the samples of each square, in the mesh's unit.
    displacement : ndarray, shape (n, 2)
        Mean displacement, in the mesh's unit.
    strains : ndarray, shape (n, 3)
        Mean Green-Lagrange strains ``exx, eyy, exy``, which a rigid motion does not change.
    left_out : int
        Number of squares of the mesh that were not measured.
    """

    points: Floats
    displacement: Floats
    strains: Floats
    left_out: int


def square_samples(mesh: Mesh, size: float) -> Floats:
    """Return the samples of the squares that lie in the mesh.

    The squares fill the box around the mesh, in its middle.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    size : float
        Side of the squares, in the mesh's unit.

    Returns
    -------
    ndarray, shape (squares, 100, 2)
        Centres of 10 x 10 equal parts of each square at least half of which lies in the mesh; NaN where a sample lies
        outside.

    Raises
    ------
    OptionError
        If the size is not positive, or fewer than two squares fit.
    """
    if not 0.0 < size < np.inf:
        raise OptionError(f"square={size}: give the side of the squares in the mesh's unit, above 0.", "square")
    corners = mesh.points[mesh.used_nodes, :2]
    low, high = corners.min(axis=0), corners.max(axis=0)
    counts = np.floor((high - low) / size * (1.0 + 1e-9)).astype(int)
    if counts.prod() < 2:
        width, height = high - low
        raise OptionError(
            f"square={size:g}: fewer than two squares fit into the mesh of {width:.4g} x {height:.4g}; give smaller "
            "ones.",
            "square",
        )
    first = 0.5 * (low + high - counts * size)
    parts = (np.arange(_SAMPLES) + 0.5) / _SAMPLES * size
    part = np.stack(np.meshgrid(parts, parts), axis=-1).reshape(-1, 2)
    places = np.stack(np.meshgrid(*(np.arange(count) * size for count in counts)), axis=-1).reshape(-1, 1, 2)
    samples: Floats = first + places + part
    inside = np.isfinite(mesh.interpolate(np.ones((mesh.num_nodes, 1)), samples.reshape(-1, 2))).reshape(
        len(samples), -1
    )
    samples[~inside] = np.nan
    kept: Floats = samples[inside.mean(axis=1) >= _LEAST_SHARE]
    return kept


def average_over_squares(result: Result, size: float) -> SquareField:
    """Average a result over squares.

    Parameters
    ----------
    result : Result
        The result.
    size : float
        Side of the squares, in the mesh's unit.

    Returns
    -------
    SquareField
        Squares of which less than half was measured are left out.

    Raises
    ------
    OptionError
        As `square_samples`.
    """
    samples = square_samples(result.mesh, size)
    inside = np.isfinite(samples[..., 0])
    displacement = np.full((*inside.shape, 2), np.nan)
    strains = np.full((*inside.shape, 3), np.nan)
    displacement[inside] = result.at(samples[inside])
    strains[inside] = result.strains("green-lagrange", at=samples[inside]).components
    known = np.isfinite(np.concatenate([displacement, strains], axis=2).sum(axis=2))
    kept = known.sum(axis=1) >= _LEAST_SHARE * inside.sum(axis=1)
    counts = known[kept].sum(axis=1)[:, np.newaxis]

    def mean(values: Floats) -> Floats:
        return np.asarray(np.where(known[kept][..., np.newaxis], values[kept], 0.0).sum(axis=1) / counts)

    return SquareField(mean(samples), mean(displacement), mean(strains), int(np.count_nonzero(~kept)))
