"""Mesh files."""

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import StrPath
from fedic.errors import MeshError
from fedic.io._mesh_file import MeshFile
from fedic.io._meshio import FORMATS
from fedic.io._programs import PROGRAM_SUFFIXES, program_reader
from fedic.io._reader_process import read_in_process
from fedic.io.mesh_parts import check_whole, chosen, without_repeated_cells
from fedic.io.msh import read_msh
from fedic.io.vtk import read_legacy_vtk, read_xml_vtk

__all__ = ["read_mesh", "split_choice"]

_READERS: dict[str, Callable[[Path], MeshFile]] = {
    **dict.fromkeys(FORMATS, partial(read_in_process, "meshio")),
    **dict.fromkeys((".e", ".ex2", ".exo", ".g", ".gen"), partial(read_in_process, "exodus")),
    **dict.fromkeys((".xdmf", ".xmf"), partial(read_in_process, "xdmf")),
    ".med": partial(read_in_process, "med"),
    ".msh": read_msh,
    ".vtk": read_legacy_vtk,
    ".vtp": read_xml_vtk,
    ".vtu": read_xml_vtk,
}
"""Reader of each suffix; files of finite element programs are told by `program_reader`."""

MAX_BYTES = 2**32
"""Largest mesh file that is read: 4 GiB, some 50 million cells."""


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
        restricted to the part chosen. A set of lines, such as a boundary, holds their nodes.

    Raises
    ------
    MeshError
        If the file is missing, is larger than 4 GiB, cannot be read, holds no surface cell, or nothing of the name
        chosen.
    """
    file, choice = split_choice(path)
    read = _reader(file)
    try:
        contents = read(file)
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
        return Mesh(np.ascontiguousarray(points, dtype=np.float64), cells, contents.sets())
    except MeshError as error:
        raise MeshError(f"{file}: {error}", error.cells, error.nodes) from error


def _reader(file: Path) -> Callable[[Path], MeshFile]:
    """Return the reader of a file, which must be there, be regular and not be too large."""
    if not _is_file(file):
        raise MeshError(f"{file}: there is no such mesh file, or it is no regular file; check the path.")
    try:
        size = file.stat().st_size
        file.open("rb").close()
    except OSError as error:
        raise MeshError(f"{file}: the mesh file cannot be read ({error.strerror}).") from error
    if not size:
        raise MeshError(f"{file}: the mesh file is empty (0 bytes); export it again.")
    if size > MAX_BYTES:
        raise MeshError(f"{file}: the mesh file has {size} bytes, more than the {MAX_BYTES} that are read.")
    read = program_reader(file) or _READERS.get(file.suffix.lower())
    if read is None:
        raise MeshError(
            f"{file}: the mesh file cannot be read (the suffix {file.suffix!r} names no format that fedic "
            f"reads, which are {', '.join(sorted({*_READERS, *PROGRAM_SUFFIXES}))})."
        )
    return read


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
