"""Readers of mesh files, by suffix, and by contents where several programs use a suffix."""

import re
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path

from fedic.errors import MeshError
from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats._lines import first_lines
from fedic.io.mesh_formats._meshio import FORMATS
from fedic.io.mesh_formats._process import read_in_process

__all__ = ["mesh_reader"]

Reader = Callable[[Path], MeshFile]


def _of(package: str, name: str) -> Reader:
    """Return a reader whose package is imported when it is first used."""

    def read(path: Path) -> MeshFile:
        found: Reader = getattr(import_module(f"fedic.io.mesh_formats.{package}"), name)
        return found(path)

    read.__name__ = name
    return read


_ABAQUS, _ANSYS, _NASTRAN = _of("abaqus", "read_abaqus"), _of("ansys", "read_ansys"), _of("nastran", "read_nastran")
_XML_VTK = _of("vtk", "read_xml_vtk")
_READERS: dict[str, Reader] = {
    **dict.fromkeys(FORMATS, partial(read_in_process, "_meshio", "read_with_meshio")),
    **dict.fromkeys((".bdf", ".fem", ".nas"), _NASTRAN),
    **dict.fromkeys((".e", ".ex2", ".exo", ".g", ".gen"), partial(read_in_process, "hdf", "read_exodus")),
    **dict.fromkeys((".xdmf", ".xmf"), partial(read_in_process, "hdf", "read_xdmf")),
    ".cdb": _ANSYS,
    ".inp": _ABAQUS,
    ".med": partial(read_in_process, "hdf", "read_med"),
    ".msh": _of("msh", "read_msh"),
    ".unv": _of("unv", "read_unv"),
    ".vtk": _of("vtk", "read_legacy_vtk"),
    ".vtp": _XML_VTK,
    ".vtu": _XML_VTK,
}
"""Reader of each suffix."""

_SHARED_SUFFIXES = (".inp", ".dat")
_PROGRAMS: tuple[tuple[re.Pattern[str], Reader], ...] = (
    (
        re.compile(
            r"\*\s*(HEADING|NODE|ELEMENT|PART|INCLUDE|NSET|ELSET|SYSTEM|PREPRINT|ASSEMBLY|PARAMETER|NGEN)\b",
            re.IGNORECASE,
        ),
        _ABAQUS,
    ),
    (
        re.compile(
            r"/[A-Z]|(NBLOCK|EBLOCK|CMBLOCK|ET|N|E|EN|MP|KEYOPT|TYPE|CSYS|\*SET|\*GET|\*DIM)\s*,", re.IGNORECASE
        ),
        _ANSYS,
    ),
    (
        re.compile(
            r"(BEGIN\s+BULK|SOL\s+\w+|CEND|"
            r"(GRID|GRDSET|CORD[12][RCS]|C(QUAD|TRIA|HEXA|TETRA|PENTA)\w*|PSHELL|PSOLID|MAT1)\*?[\s,])",
            re.IGNORECASE,
        ),
        _NASTRAN,
    ),
)
"""Beginnings of lines that tell the program which wrote a file of a shared suffix."""


def mesh_reader(path: Path) -> Reader:
    """Return what reads a mesh file.

    Parameters
    ----------
    path : Path
        The file. Several programs use ``.inp`` and ``.dat``: there the first line that is known tells the reader, and
        without one the suffix does.

    Returns
    -------
    callable
        Called with the path, it returns the contents as a `MeshFile`, or raises a MeshError.

    Raises
    ------
    MeshError
        If no format has the suffix, or the file cannot be read.
    """
    suffix = path.suffix.lower()
    if suffix not in _READERS:
        raise MeshError(
            f"{path}: the mesh file cannot be read (the suffix {path.suffix!r} names no format that fedic reads, which "
            f"are {', '.join(sorted(_READERS))})."
        )
    for line in first_lines(path) if suffix in _SHARED_SUFFIXES else ():
        for pattern, reader in _PROGRAMS:
            if pattern.match(line.strip()):
                return reader
    return _READERS[suffix]
