"""Labels of the nodes and cells of a mesh, as the program that made it numbers them."""

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh

__all__ = ["cell_labels", "node_labels"]


def node_labels(mesh: Mesh) -> NDArray[np.int64]:
    """Return the labels of the nodes.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    ndarray, shape (n,)
        ``mesh.node_labels`` if it has them, or else the indices from 0.
    """
    return _labels(mesh.node_labels, mesh.num_nodes)


def cell_labels(mesh: Mesh) -> NDArray[np.int64]:
    """Return the labels of the cells.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    ndarray, shape (num_cells,)
        ``mesh.cell_labels`` if it has them, or else the indices from 0.
    """
    return _labels(mesh.cell_labels, mesh.num_cells)


def _labels(labels: NDArray[np.int64] | None, count: int) -> NDArray[np.int64]:
    return np.arange(count) if labels is None else labels
