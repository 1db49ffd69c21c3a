"""Comparison of cells by their nodes."""

import numpy as np

from fedic.io._mesh_file import Indices

__all__ = ["corner_keys", "groups_of"]


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
