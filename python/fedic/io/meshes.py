"""Mesh files."""

import os
from pathlib import Path

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import StrPath
from fedic.errors import MeshError
from fedic.io.files import check_file
from fedic.io.limits import MAX_BYTES
from fedic.io.mesh_formats import mesh_reader
from fedic.io.mesh_parts import check_whole, chosen, without_repeated_cells

__all__ = ["read_mesh", "split_choice"]


def read_mesh(path: StrPath) -> Mesh:
    """Read the surface cells of a mesh file, and its named sets.

    ``"plate.msh#SKIN"`` reads one part of the file: a named set of cells, a block or part, a physical group of Gmsh by
    its name or number, faces of solids by the name of a surface or of a set of nodes, or the cells in one side of the
    bounding box, ``x-min`` to ``z-max``. Without a choice all cells of the types in `CELL_TYPES` are read, and points,
    lines and solids are left out. A cell that the file holds twice is read once. See docs/meshes.md for the formats.

    Parameters
    ----------
    path : str or path
        The mesh file; its suffix names the format. A choice follows after ``#``, unless a file has that whole name.

    Returns
    -------
    Mesh
        With all nodes of the file, in the file's order and unit, so that node ``i`` is still the ``i``-th of the file,
        also after a choice. Nodes are 2-D if ``z`` is zero at all nodes of its cells, 3-D otherwise. ``mesh.sets``
        holds Abaqus's ``*NSET`` and ``*ELSET``, Gmsh's named physical groups and the sets that `Mesh.write` writes,
        restricted to the part chosen. A set of lines, such as a boundary, holds their nodes. ``mesh.node_labels`` and
        ``mesh.cell_labels`` are the numbers of the nodes and cells in the file, None if it has none or two are equal.

    Raises
    ------
    MeshError
        If the file is missing, is larger than 4 GiB, cannot be read, holds no surface cell, or nothing of the name
        chosen.
    """
    file, choice = split_choice(path)
    check_file(file, MeshError, "mesh file", MAX_BYTES)
    if not file.stat().st_size:
        raise MeshError(f"{file}: the mesh file is empty (0 bytes); export it again.")
    try:
        contents = mesh_reader(file)(file)
    except MemoryError as error:
        raise MeshError(f"{file}: there is not enough memory to read the mesh file.") from error
    contents.check_nodes(file)
    contents = without_repeated_cells(contents)
    if choice is None:
        check_whole(file, contents)
    else:
        contents = chosen(file, contents, choice)
    points, cells = contents.points, contents.surface_cells()
    used = np.unique(np.concatenate([nodes.ravel() for nodes in cells.values()]))
    if points.shape[1] == 3 and not points[used, 2].any():
        points = points[:, :2]
    try:
        return Mesh(np.ascontiguousarray(points, dtype=np.float64), cells, contents.sets(), *contents.labels())
    except MeshError as error:
        raise MeshError(f"{file}: {error}", error.cells, error.nodes) from error


def split_choice(path: StrPath) -> tuple[Path, str | None]:
    """Split a path such as ``plate.msh#SKIN`` into the mesh file and the part chosen from it.

    Parameters
    ----------
    path : str or path
        Path of a mesh file, with or without a choice.

    Returns
    -------
    file : Path
        The whole path if such a file exists or nothing is chosen.
    choice : str or None
        What follows the first ``#`` before which the path is that of a file.

    Raises
    ------
    MeshError
        If nothing follows the ``#``.
    """
    text = os.fspath(path)
    places = [place for place, letter in enumerate(text) if letter == "#"]
    if not places or _is_file(Path(text)):
        return Path(text), None
    place = next((place for place in places if _is_file(Path(text[:place]))), places[0])
    choice = text[place + 1 :].strip()
    if not choice:
        raise MeshError(f"{text}: nothing follows the '#'; write the name of a part of the mesh, or leave the '#' out.")
    return Path(text[:place]), choice


def _is_file(path: Path) -> bool:
    return os.path.isfile(path)  # noqa: PTH113 - unlike Path.is_file it raises no error for a name that cannot be one
