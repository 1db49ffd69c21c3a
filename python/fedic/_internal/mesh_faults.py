"""Warnings of meshes that can be measured but may not be meant: seams and strongly distorted cells."""

import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic._internal.warning_level import levels_within_fedic
from fedic.errors import QualityWarning

__all__ = ["warn_of_mesh_faults"]

_SHOWN = 8
_STRAIGHT = 1e-3
"""Extent across a seam, relative to that of the mesh, up to which it lies along a line."""


def warn_of_mesh_faults(mesh: Mesh) -> None:
    """Warn of seams, along which the displacement may jump, and of strongly distorted cells."""
    for message in (*_seams(mesh), _distortion(mesh)):
        if message:
            warnings.warn(message, QualityWarning, stacklevel=levels_within_fedic())


def _seams(mesh: Mesh) -> list[str]:
    pairs = mesh.coincident_nodes()
    points = mesh.points
    messages = []
    if len(pairs):
        apart = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1).max()
        remedy = f"mesh.merge_nodes({2.0 * apart:.1g}) joins them"
        used = int(mesh.used_nodes.sum())
        if mesh.num_cells > 1 and used == sum(nodes.size for nodes in mesh.cells.values()):
            return [
                "no two cells share a node, so that each cell is measured alone: "
                f"the {used} nodes are at {used - len(pairs)} places; {remedy}"
            ]
        count = "1 pair of nodes is" if len(pairs) == 1 else f"{len(pairs)} pairs of nodes are"
        messages.append(
            f"{count} at one place {_place(points, pairs[:, 0])} "
            f"(nodes {_listed([f'{first} and {other}' for first, other in pairs])}): "
            f"the displacement may jump there; unless that is a crack, {remedy}"
        )
    hanging = mesh.hanging_nodes()
    if len(hanging):
        count = "1 node lies" if len(hanging) == 1 else f"{len(hanging)} nodes lie"
        messages.append(
            f"{count} on the edge of a cell without being its node {_place(points, hanging)} "
            f"(nodes {_listed(hanging)}): the displacement may jump there; make the nodes of both sides match"
        )
    return messages


def _listed(items: Sequence[object] | NDArray[np.int64]) -> str:
    rest = f" and {len(items) - _SHOWN} more" if len(items) > _SHOWN else ""
    return ", ".join(map(str, items[:_SHOWN])) + rest


def _place(points: Floats, nodes: NDArray[np.int64]) -> str:
    seam = points[nodes]
    low, high = seam.min(axis=0), seam.max(axis=0)
    constant = high - low <= _STRAIGHT * np.ptp(points, axis=0).max()
    if constant.all():
        return f"at {_point(low)}"
    for axis, name in enumerate("xy"):
        if constant[axis]:
            return f"along {name} = {seam[:, axis].mean():.6g}"
    return f"between {_point(low)} and {_point(high)}"


def _point(point: Floats) -> str:
    return f"({', '.join(f'{c:.6g}' for c in point)})"


def _distortion(mesh: Mesh) -> str:
    cells = mesh.distorted_cells()
    if not len(cells):
        return ""
    cells_are = "cell {} is" if len(cells) == 1 else "cells {} are"
    return (
        f"{cells_are.format(_listed(cells))} strongly distorted: the area element at one node is less than 1/30 of "
        "that at another, and the displacement may be imprecise there; improve the mesh, or use triangles"
    )
