"""Writers of mesh files, by format."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic.io.mesh_formats._meshio import write_with_meshio
from fedic.io.mesh_formats._set_fields import set_fields

__all__ = ["mesh_writer"]

_Indices = Mapping[str, NDArray[np.int64]]
_Labels = NDArray[np.int64] | None
_Writer = Callable[[Path, NDArray[np.float64], _Indices, _Indices, _Indices], None]


def mesh_writer(path: Path, node_labels: _Labels = None, cell_labels: _Labels = None) -> _Writer:
    """Return what writes a mesh file.

    Parameters
    ----------
    path : Path
        The file; its suffix names the format.
    node_labels, cell_labels : ndarray of int, or None
        Labels of the nodes and cells, cells counted over all types; formats that do not hold them go without.

    Returns
    -------
    callable
        Called with the path, the nodes of shape (n, 3), the cells by type, the nodes of each named set, and the cells
        of each named set, counted over all types. It raises a MeshError if the format cannot hold the mesh.
    """
    suffix = path.suffix.lower()
    if suffix == ".inp":
        from fedic.io.mesh_formats.abaqus import write_abaqus

        return partial(write_abaqus, node_labels=node_labels, cell_labels=cell_labels)
    return _write_vtu if suffix == ".vtu" else write_with_meshio


def _write_vtu(
    path: Path, points: NDArray[np.float64], cells: _Indices, node_sets: _Indices, cell_sets: _Indices
) -> None:
    from fedic.io.mesh_formats.vtk import write_vtu

    num_cells = sum(len(nodes) for nodes in cells.values())
    write_vtu(path, points, cells, set_fields(node_sets, len(points)), set_fields(cell_sets, num_cells), {})
