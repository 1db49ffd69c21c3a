"""Places of a mesh where fields are read: points, gauges, sets, the whole mesh."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.errors import OptionError
from fedic.probes.cell_points import CellPoints, cells_of_points, typical_cell_size
from fedic.probes.gauge import Gauge

__all__ = ["At", "NodeMean", "Place", "places_of"]

At: TypeAlias = "str | Gauge | Sequence[str | Gauge] | ArrayLike | None"
"""Places: the whole mesh, the name of a set, gauges, or points of shape (m, 2)."""

_OUTSIDE = 0.01
"""Largest share of a gauge outside the mesh."""


@dataclass(frozen=True, eq=False)
class NodeMean:
    """A mean of interpolated nodal values.

    Attributes
    ----------
    nodes : ndarray of int, shape (m, k)
        Nodes of each point.
    shapes : ndarray, shape (m, k)
        Weight of each of these nodes at the point, with the sum 1.
    weights : ndarray, shape (m,)
        Weight of each point in the mean, with the sum 1.
    """

    nodes: NDArray[np.int64]
    shapes: Floats
    weights: Floats


@dataclass(frozen=True, eq=False)
class Place:
    """A place where fields are read.

    Attributes
    ----------
    name : str
        Name in the columns of tables; empty for its number.
    nodal : NodeMean
        The mean of the displacement.
    cells : CellPoints or None
        Points where the strain is read; None for a set without cells.
    weights : ndarray, shape (m,)
        Their weights in the mean, with the sum 1.
    ends : ndarray, shape (2, 2), or None
        Points of an extensometer; None for other places.
    """

    name: str
    nodal: NodeMean
    cells: CellPoints | None
    weights: Floats
    ends: Floats | None = None

    def __str__(self) -> str:
        return f"place {self.name!r}" if self.name else "the place"


def places_of(mesh: Mesh, at: At) -> list[Place]:
    """Find places of a mesh.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    at : None, str, Gauge, sequence of them, or array_like of shape (m, 2)
        The whole mesh, the name of a set, gauges, or points in the mesh's unit.

    Returns
    -------
    list of Place
        In the order given.

    Raises
    ------
    OptionError
        If a set does not exist, a point or a gauge lies outside the mesh, or two places have one name.
    """
    if at is None:
        used = np.flatnonzero(mesh.used_nodes)
        return [_of_cells("", mesh, used, np.arange(mesh.num_cells))]
    if isinstance(at, (str, Gauge)):
        return [_place(mesh, at)]
    if isinstance(at, Iterable) and not hasattr(at, "__array__"):
        given = list(at)
        if any(isinstance(each, (str, Gauge)) for each in given):
            places = [_place(mesh, each) for each in given]
            names = [place.name or str(index) for index, place in enumerate(places)]
            twice = next((name for name in names if names.count(name) > 1), None)
            if twice is not None:
                raise OptionError(f"at has two places named {twice!r}; give each another name.", "at")
            return places
    return _points(mesh, at)


def _place(mesh: Mesh, at: object) -> Place:
    if isinstance(at, Gauge):
        return _gauge(mesh, at)
    if isinstance(at, str):
        found = mesh.sets.get(at)
        if found is None:
            known = ", ".join(repr(name) for name in mesh.sets) or "none"
            raise OptionError(f"at={at!r}: the mesh has no set of this name; its sets are: {known}.", "at")
        return _of_cells(at, mesh, found.nodes, found.cells)
    raise OptionError(f"at has {at!r} among gauges; give gauges and names of sets, or points alone.", "at")


def _of_cells(name: str, mesh: Mesh, nodes: NDArray[np.int64], cells: NDArray[np.int64]) -> Place:
    kept = np.unique(cells)
    share = np.full(len(nodes), 1.0 / max(len(nodes), 1))
    nodal = NodeMean(nodes[:, np.newaxis], np.ones((len(nodes), 1)), share)
    areas = mesh.areas()[kept]
    return Place(name, nodal, CellPoints(mesh, kept, None) if len(kept) else None, areas / max(areas.sum(), 1e-300))


def _points(mesh: Mesh, at: object) -> list[Place]:
    try:
        points = np.array(at, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise OptionError(f"at={at!r}: give points (x, y), gauges, or the name of a set.", "at") from error
    if points.ndim != 2 or points.shape[1] != 2 or not len(points) or not np.isfinite(points).all():
        raise OptionError(
            f"at has shape {points.shape}; give finite points (x, y), shape (m, 2), gauges, or the name of a set.", "at"
        )
    cells = cells_of_points(mesh, points)
    for index in np.flatnonzero(cells < 0)[:1]:
        x, y = points[index]
        raise OptionError(f"at: point {index}, ({x:g}, {y:g}), lies outside the mesh; {_extent(mesh)}.", "at")
    return [_at_points("", mesh, points[[k]], cells[[k]], np.ones(1)) for k in range(len(points))]


def _gauge(mesh: Mesh, gauge: Gauge) -> Place:
    points, weights = gauge.samples(typical_cell_size(mesh))
    # Corners on the border of the mesh are looked for a little inside.
    nearest = [points[np.argmin(np.hypot(*(points - corner).T))] for corner in gauge.points]
    corners = gauge.points + 1e-6 * (np.array(nearest) - gauge.points)
    cells = cells_of_points(mesh, np.vstack([corners, points]))
    outside = cells[: len(corners)] < 0
    if outside.any():
        x, y = gauge.points[np.flatnonzero(outside)[0]]
        raise OptionError(f"at: {gauge} has the point ({x:g}, {y:g}) outside the mesh; {_extent(mesh)}.", "at")
    inside = cells[len(corners) :] >= 0
    if weights[~inside].sum() > _OUTSIDE:
        raise OptionError(
            f"at: {weights[~inside].sum():.0%} of {gauge} lie outside the mesh, in a hole or beyond its border; make "
            "the gauge smaller.",
            "at",
        )
    kept = weights[inside] / weights[inside].sum()
    ends = gauge.points if gauge.kind == "extensometer" else None
    return _at_points(gauge.name, mesh, points[inside], cells[len(corners) :][inside], kept, ends)


def _at_points(
    name: str, mesh: Mesh, points: Floats, cells: NDArray[np.int64], weights: Floats, ends: Floats | None = None
) -> Place:
    found = CellPoints(mesh, cells, points)
    return Place(name, NodeMean(found.nodes, found.shapes(), weights), found, weights, ends)


def _extent(mesh: Mesh) -> str:
    (x0, y0), (x1, y1) = (f(mesh.points[mesh.used_nodes, :2], axis=0) for f in (np.min, np.max))
    return f"it reaches from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g})"
