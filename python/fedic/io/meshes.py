"""Mesh files."""

from pathlib import Path

import numpy as np

from fedic._core import CELL_TYPES, Mesh
from fedic._internal.types import StrPath
from fedic.errors import MeshError
from fedic.io._meshio import read_with_meshio
from fedic.io._programs import program_reader

__all__ = ["read_mesh"]


def read_mesh(path: StrPath) -> Mesh:
    """Read the surface cells of a mesh file, and its named sets.

    Files of Abaqus, Ansys and Nastran and universal files (.unv) are read by fedic, all other formats (Gmsh, VTK, VTU,
    MED, ...) by meshio. Cells of the types in `CELL_TYPES` are kept; points, lines and volumes are left out.

    Parameters
    ----------
    path : str or path
        The mesh file; its suffix names the format.

    Returns
    -------
    Mesh
        With all nodes of the file, in the file's order and unit, so that node ``i`` is still the ``i``-th of the file.
        Nodes are 2-D if every ``z`` is zero, 3-D otherwise. ``mesh.sets`` holds Abaqus's ``*NSET`` and ``*ELSET``,
        Gmsh's named physical groups and the sets that `Mesh.write` writes. A set of lines, such as a boundary, holds
        their nodes.

    Raises
    ------
    MeshError
        If the file is missing, cannot be read, or holds no surface cell.
    """
    path = Path(path)
    if not path.is_file():
        raise MeshError(f"{path}: there is no such mesh file; check the path.")
    contents = (program_reader(path) or read_with_meshio)(path)
    if contents.needs_selection:
        raise MeshError(contents.needs_selection)
    cells = contents.surface_cells()
    if not cells:
        found = ", ".join(sorted({name for name, _ in contents.blocks})) or "none"
        raise MeshError(
            f"{path}: no surface cell to correlate on (cells found: {found}); "
            f"export the surface as one of {', '.join(CELL_TYPES)}."
        )
    points = contents.points
    if points.shape[1] == 3 and not points[:, 2].any():
        points = points[:, :2]
    try:
        return Mesh(np.ascontiguousarray(points, dtype=np.float64), cells, contents.sets())
    except MeshError as error:
        raise MeshError(f"{path}: {error}", error.cells, error.nodes) from error
