"""Edges of a mesh given by the names of sets or by nodes."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._core import CELL_TYPES, Mesh
from fedic.errors import OptionError

__all__ = ["Edges", "Given", "checked_edges", "edge_nodes", "with_middle_nodes"]

Edges: TypeAlias = str | ArrayLike | Sequence[str | ArrayLike]
Given: TypeAlias = tuple[str | tuple[int, ...], ...]
"""Names of sets and groups of nodes."""


def checked_edges(edges: Edges, option: str) -> Given:
    """Return edges as names of sets and groups of nodes.

    Parameters
    ----------
    edges : str, array_like of int, or sequence of these
        The name of a set, nodes, or several of them.
    option : str
        Name of the argument, for errors.

    Raises
    ------
    OptionError
        If they are neither.
    """
    if isinstance(edges, str):
        return (edges,)
    if not isinstance(edges, (list, tuple, np.ndarray)):
        raise _refusal(option, edges)
    given = list(edges)
    if given and all(isinstance(each, (int, np.integer)) and not isinstance(each, bool) for each in given):
        return (_nodes(given, option),)
    return tuple(each if isinstance(each, str) else _nodes(each, option) for each in given)


def edge_nodes(given: Given, mesh: Mesh, option: str) -> NDArray[np.int64]:
    """Return the nodes of edges of a mesh, ascending.

    Raises
    ------
    OptionError
        If the mesh has no such set or node, or a node is not at its boundary.
    """
    sets, boundary = mesh.sets, mesh.boundary_nodes
    groups = [np.empty(0, dtype=np.int64)]
    for each in given:
        if isinstance(each, str) and each not in sets:
            known = f"its sets are {', '.join(map(repr, sets))}" if sets else "it has no sets"
            raise OptionError(f"{option}: the mesh has no set {each!r}; {known}", option)
        nodes = sets[each].nodes if isinstance(each, str) else np.array(each, dtype=np.int64)
        what = f"the set {each!r}" if isinstance(each, str) else "the nodes given"
        outside = nodes[(nodes < 0) | (nodes >= mesh.num_nodes)]
        if outside.size:
            raise OptionError(
                f"{option}: {what} have node {outside[0]}; the mesh has {mesh.num_nodes} nodes, from 0 on", option
            )
        inside = nodes[~boundary[nodes]]
        if inside.size:
            raise OptionError(
                f"{option}: {inside.size} of {nodes.size} nodes of {what} are not at the boundary of the mesh, the "
                f"first being node {inside[0]}; name nodes of edges",
                option,
            )
        groups.append(nodes)
    return np.unique(np.concatenate(groups))


def with_middle_nodes(nodes: NDArray[np.int64], mesh: Mesh) -> NDArray[np.int64]:
    """Add the middle nodes of quadratic edges both of whose ends are given: sets of some programs have corners only."""
    given = np.zeros(mesh.num_nodes, dtype=np.bool_)
    given[nodes] = True
    added = given.copy()
    for name, outline in zip(mesh.cells, mesh.outlines(), strict=True):
        if CELL_TYPES[name].edge_intervals == 2:
            ends, middles = outline[:, ::2], outline[:, 1::2]
            added[middles[given[ends] & given[np.roll(ends, -1, axis=1)]]] = True
    return np.flatnonzero(added & mesh.boundary_nodes)


def _nodes(nodes: object, option: str) -> tuple[int, ...]:
    try:
        array = np.asarray(nodes)
    except ValueError:
        raise _refusal(option, nodes) from None
    if array.ndim != 1 or not (array.dtype.kind in "iu" or array.size == 0):
        raise _refusal(option, nodes)
    return tuple(int(node) for node in array)


def _refusal(option: str, edges: object) -> OptionError:
    return OptionError(
        f"{option} must be the name of a set of the mesh, an array of nodes, or a list of these, got {edges!r:.80}",
        option,
    )
