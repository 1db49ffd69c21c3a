"""Points in cells of a mesh: displacement and strain there, and their derivatives with respect to the nodes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.results.strains import StrainAxes, StrainMeasure

__all__ = ["CellPoints", "StrainOptions", "cells_of_points", "typical_cell_size"]

_STEP = 1e-4
"""Step of the central differences of strains, relative to the size of the cells: they are exact for Green-Lagrange and
small strains, and right to 1e-8 for Hencky strains."""


@dataclass(frozen=True, eq=False)
class StrainOptions:
    """Arguments of `Mesh.strains`.

    Attributes
    ----------
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.
    axes : float or "cylindrical", optional
        Axes of the components.
    centre : array_like, shape (2,), optional
        Centre of cylindrical axes.
    """

    measure: StrainMeasure = "green-lagrange"
    axes: StrainAxes | None = None
    centre: ArrayLike | None = None


class CellPoints:
    """Points that each lie in a known cell.

    The cells that hold them are taken apart, so that each has nodes of its own: all cells are then evaluated at once.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    cells : ndarray of int, shape (m,)
        Cell of each point.
    points : ndarray, shape (m, 2), or None
        The points; None for the centres of the cells, each of which is given once and in order.

    Attributes
    ----------
    cells : ndarray of int, shape (m,)
        Cell of each point.
    nodes : ndarray of int, shape (m, k)
        Nodes of the cell of each point; filled with its first node.
    """

    def __init__(self, mesh: Mesh, cells: NDArray[np.int64], points: Floats | None) -> None:
        kept, place = np.unique(cells, return_inverse=True)
        self.cells = cells
        self._kept = kept
        self._points = points
        self._apart = _Apart(mesh, kept)
        self._size = typical_cell_size(self._apart.mesh)
        self.nodes = self._apart.table[place]

    def shapes(self) -> Floats:
        """Return the shape functions at the points.

        Returns
        -------
        ndarray, shape (m, k)
            Of each of `nodes`; zero for those that fill.
        """
        points = self._points
        if points is None:
            apart = self._apart.mesh
            points = apart.strains(np.zeros((apart.num_nodes, 2))).positions
        shapes = self._apart.mesh.interpolate(np.eye(self.nodes.shape[1])[self._apart.slot], points)
        shapes[np.abs(shapes) < 1e-12] = 0.0
        return shapes

    def strains(self, displacement: Floats, valid_cells: NDArray[np.bool_], options: StrainOptions) -> Floats:
        """Return the strains at the points.

        Parameters
        ----------
        displacement : ndarray, shape (n, 2)
            Displacement of the nodes of the mesh.
        valid_cells : ndarray of bool, shape (num_cells,)
            Cells that were measured.
        options : StrainOptions
            Measure and axes.

        Returns
        -------
        ndarray, shape (m, 3)
            ``exx, eyy, exy``; NaN where not measured.
        """
        return self._strains(displacement[self._apart.node], valid_cells[self._kept], options)

    def strain_slopes(self, displacement: Floats, options: StrainOptions) -> Floats:
        """Return the derivatives of the strains with respect to the displacement of the nodes, by central differences.

        Parameters
        ----------
        displacement : ndarray, shape (n, 2)
            Displacement of the nodes of the mesh.
        options : StrainOptions
            Measure and axes.

        Returns
        -------
        ndarray, shape (m, 3, k, 2)
            Of each component with respect to the displacement of each of `nodes`; zero for those that fill.
        """
        base = np.nan_to_num(displacement[self._apart.node])
        valid = np.ones(len(self._kept), dtype=bool)
        step = _STEP * self._size
        slopes = np.zeros((len(self.cells), 3, self.nodes.shape[1], 2))
        for slot in range(self.nodes.shape[1]):
            for axis in range(2):
                change = np.zeros_like(base)
                change[self._apart.slot == slot, axis] = step
                after, before = (self._strains(base + sign * change, valid, options) for sign in (1.0, -1.0))
                slopes[:, :, slot, axis] = (after - before) / (2.0 * step)
        return slopes

    def _strains(self, displacement: Floats, valid_cells: NDArray[np.bool_], options: StrainOptions) -> Floats:
        found = self._apart.mesh.strains(
            displacement,
            options.measure,
            "cells" if self._points is None else self._points,
            options.axes,
            centre=options.centre,
            valid_cells=valid_cells,
        )
        return found.components


def cells_of_points(mesh: Mesh, points: Floats) -> NDArray[np.int64]:
    """Find the cells of points.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    points : ndarray, shape (m, 2)
        Points of the ``(x, y)`` plane.

    Returns
    -------
    ndarray of int, shape (m,)
        Indices of the cells; -1 outside the mesh.
    """
    apart = _Apart(mesh, np.arange(mesh.num_cells))
    found = apart.mesh.interpolate(apart.owner[:, np.newaxis].astype(np.float64), points)[:, 0]
    return np.where(np.isfinite(found), np.rint(np.nan_to_num(found)), -1).astype(np.int64)


def typical_cell_size(mesh: Mesh) -> float:
    """Return the square root of the median area of the cells.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    float
        In the mesh's unit.
    """
    return float(np.sqrt(np.median(mesh.areas())))


class _Apart:
    """Cells of a mesh with nodes of their own.

    Attributes
    ----------
    mesh : Mesh
        The cells, in order.
    table : ndarray of int, shape (c, k)
        Nodes of each cell in the whole mesh; filled with its first node.
    node, slot, owner : ndarray of int
        Of each node of the separate cells: the node in the whole mesh, its place in the cell, and the cell in the whole
        mesh.
    """

    def __init__(self, mesh: Mesh, cells: NDArray[np.int64]) -> None:
        blocks: dict[str, NDArray[np.int64]] = {}
        nodes, slots, owners, tables = [], [], [], []
        width = max(table.shape[1] for table in mesh.cells.values())
        first = count = 0
        for name, whole in mesh.cells.items():
            here = cells[(cells >= first) & (cells < first + len(whole))]
            table = whole[here - first]
            first += len(whole)
            if not len(table):
                continue
            blocks[name] = count + np.arange(table.size).reshape(table.shape)
            count += table.size
            nodes.append(table.ravel())
            slots.append(np.tile(np.arange(table.shape[1]), len(table)))
            owners.append(np.repeat(here, table.shape[1]))
            fill = np.repeat(table[:, :1], width - table.shape[1], axis=1)
            tables.append(np.hstack([table, fill]))
        self.node, self.slot, self.owner = (np.concatenate(each) for each in (nodes, slots, owners))
        self.table = np.vstack(tables)
        self.mesh = Mesh(mesh.points[self.node], blocks)
