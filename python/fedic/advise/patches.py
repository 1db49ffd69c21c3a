"""Predicted standard deviations on small meshes in parts of an image."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fedic._core import rectangle_mesh
from fedic._internal.types import CellName, Floats, Image
from fedic.correlation import Correlator
from fedic.errors import SolveError

__all__ = ["Region", "SizePrediction", "cells_along", "predict_size"]

Region = tuple[int, int, int, int]
"""First column and row, and those after the last, in pixels."""
_MOST_CELLS, _FEWEST_CELLS = 8, 3
_SIDE = 320
"""Side of a patch in pixels, about; small cells have smaller ones."""
_MARGIN = 24
"""Pixels around a patch that the interpolation of the image reads."""


@dataclass(frozen=True)
class SizePrediction:
    """Predictions for cells of one size: root mean squares over several patches.

    Attributes
    ----------
    inner, border : ndarray, shape (2,)
        Standard deviation of the displacement ``x, y`` in pixels, at nodes inside the mesh and at its border.
    strain : ndarray, shape (3,)
        Standard deviation of ``exx, eyy, exy`` at the centres of cells inside the mesh.
    undetermined : int
        Patches whose texture does not determine the displacement of some node.
    patches : int
        Number of patches.
    """

    inner: Floats
    border: Floats
    strain: Floats
    undetermined: int
    patches: int


def cells_along(region: Region, size: float) -> int:
    """Return the number of cells of a size along the sides of a patch; 0 if too few fit into the region."""
    left, top, right, bottom = region
    fitting = int((min(right - left, bottom - top) - 1) // size)
    count = min(_MOST_CELLS, max(4, int(_SIDE // size)), fitting)
    return count if count >= _FEWEST_CELLS else 0


def predict_size(
    image: Image, region: Region, size: float, cell: CellName, noise: float, options: Mapping[str, Any]
) -> SizePrediction:
    """Predict the standard deviations for cells of one size.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.
    region : Region
        The part of it that is measured, in which `cells_along` cells fit.
    size : float
        Side of the cells, in pixels.
    cell : str
        Type of the cells.
    noise : float
        Standard deviation of the noise of one image, in grey levels.
    options : mapping
        Options of `fedic.correlate`.

    Returns
    -------
    SizePrediction
        By `Correlator.covariance`; NaN if no patch can be predicted.
    """
    side = cells_along(region, size) * size
    found: list[tuple[Floats, Floats, Floats]] = []
    patches = undetermined = 0
    for left, top in _corners(region, side):
        patches += 1
        try:
            found.append(_of_patch(image, left, top, side, size, cell, noise, options))
        except SolveError:
            undetermined += 1
    if not found:
        return SizePrediction(np.full(2, np.nan), np.full(2, np.nan), np.full(3, np.nan), undetermined, patches)
    inner, border, strain = (_rms(np.concatenate(part)) for part in zip(*found, strict=True))
    return SizePrediction(inner, border, strain, undetermined, patches)


def _corners(region: Region, side: float) -> Iterator[tuple[int, int]]:
    """Yield the corners of the patches: in the middle, and in the quarters if they do not overlap by half."""
    left, top, right, bottom = region
    spare_u, spare_v = right - 1 - left - side, bottom - 1 - top - side
    yield int(left + 0.5 * spare_u), int(top + 0.5 * spare_v)
    if max(spare_u, spare_v) >= side:
        for share_u, share_v in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)):
            yield int(left + share_u * spare_u), int(top + share_v * spare_v)


def _of_patch(
    image: Image,
    left: int,
    top: int,
    side: float,
    size: float,
    cell: CellName,
    noise: float,
    options: Mapping[str, Any],
) -> tuple[Floats, Floats, Floats]:
    """Return the variances at the inner nodes, at the border, and of the strains of inner cells."""
    first_u, first_v = max(0, left - _MARGIN), max(0, top - _MARGIN)
    last_u, last_v = (int(np.ceil(start + side)) + _MARGIN for start in (left, top))
    part = image[first_v:last_v, first_u:last_u]
    low = np.array([left - first_u, top - first_v], dtype=np.float64)
    mesh = rectangle_mesh((low[0], low[1], low[0] + side, low[1] + side), size, cell)
    points = mesh.points[:, :2]
    at_border = np.any((points <= low + 1e-6) | (points >= low + side - 1e-6), axis=1)
    covariance = Correlator(part, mesh, **options).covariance(noise)
    nodal, strains = covariance.standard_deviations**2, covariance.strain_deviations("small") ** 2
    inside = np.concatenate([~np.any(at_border[nodes], axis=1) for nodes in mesh.cells.values()])
    return nodal[~at_border], nodal[at_border], strains[inside]


def _rms(variances: Floats) -> Floats:
    """Return the root mean square of each column over the rows that are known."""
    known = variances[np.isfinite(variances.sum(axis=1))]
    return np.asarray(np.sqrt(known.mean(axis=0))) if len(known) else np.full(variances.shape[1], np.nan)
