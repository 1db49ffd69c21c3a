"""Comparison of cells by their nodes."""

import numpy as np

from fedic._core import CELL_TYPES
from fedic.io._mesh_file import Block, Indices

__all__ = ["corner_keys", "groups_of", "rows_of"]


def corner_keys(nodes: Indices, num_corners: int, width: int) -> Indices:
    """Return for each cell its different corners, which name it whatever their order.

    Parameters
    ----------
    nodes : ndarray of int, shape (m, k)
        Nodes of the cells, corners first.
    num_corners : int
        Number of corners.
    width : int
        Number of columns of the result.

    Returns
    -------
    ndarray of int, shape (m, width)
        In each row the corners in descending order, each once, then -1.
    """
    corners = np.sort(nodes[:, :num_corners], axis=1)
    corners[:, 1:][corners[:, 1:] == corners[:, :-1]] = -1
    keys = np.full((len(nodes), width), -1, dtype=np.int64)
    keys[:, :num_corners] = np.sort(corners, axis=1)[:, ::-1]
    return keys


def groups_of(rows: Indices) -> Indices:
    """Return the group of equal rows to which each row belongs.

    Parameters
    ----------
    rows : ndarray of int, shape (m, k)
        Rows to compare.

    Returns
    -------
    ndarray of int, shape (m,)
        Number of the group of each row, from 0.
    """
    order = np.lexsort(rows.T)
    ordered = rows[order]
    starts = np.ones(len(rows), dtype=bool)
    starts[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.empty(len(rows), dtype=np.int64)
    group[order] = np.cumsum(starts) - 1
    return group


def rows_of(cells: list[Block], blocks: list[Block]) -> list[Indices]:
    """Find surface cells among those of a mesh.

    Parameters
    ----------
    cells : list of (str, ndarray of int, shape (m, k))
        Surface cells.
    blocks : list of (str, ndarray of int, shape (m, k))
        Cells of the mesh.

    Returns
    -------
    list of ndarray of int
        For each block, indices in the block of the cells with the same corners; none at all if one cell is not there.
    """
    surface = [index for index, (name, _) in enumerate(blocks) if name in CELL_TYPES]
    tables = [*cells, *(blocks[index] for index in surface)]
    keys = [corner_keys(nodes, CELL_TYPES[name].num_corners, width=4) for name, nodes in tables]
    groups = np.split(
        groups_of(np.concatenate([np.empty((0, 4), dtype=np.int64), *keys])), np.cumsum([*map(len, keys)])
    )
    wanted = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *groups[: len(cells)]]))
    found = [np.empty(0, dtype=np.int64) for _ in blocks]
    for index, group in zip(surface, groups[len(cells) : -1], strict=True):
        found[index] = np.flatnonzero(np.isin(group, wanted))
    there = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *groups[len(cells) :]]))
    return found if np.isin(wanted, there).all() else [rows[:0] for rows in found]
