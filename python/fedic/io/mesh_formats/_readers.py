"""Readers of mesh files, by suffix, and by contents where several programs use a suffix."""

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

from fedic.errors import MeshError
from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats._lines import first_lines
from fedic.io.mesh_formats._meshio import FORMATS
from fedic.io.mesh_formats._process import read_in_process
from fedic.io.mesh_formats.abaqus import read_abaqus
from fedic.io.mesh_formats.ansys import read_ansys
from fedic.io.mesh_formats.msh import read_msh
from fedic.io.mesh_formats.nastran import read_nastran
from fedic.io.mesh_formats.unv import read_unv
from fedic.io.mesh_formats.vtk import read_legacy_vtk, read_xml_vtk

__all__ = ["mesh_reader"]

Reader = Callable[[Path], MeshFile]
_READERS: dict[str, Reader] = {
    **dict.fromkeys(FORMATS, partial(read_in_process, "meshio")),
    **dict.fromkeys((".bdf", ".fem", ".nas"), read_nastran),
    **dict.fromkeys((".e", ".ex2", ".exo", ".g", ".gen"), partial(read_in_process, "exodus")),
    **dict.fromkeys((".xdmf", ".xmf"), partial(read_in_process, "xdmf")),
    ".cdb": read_ansys,
    ".inp": read_abaqus,
    ".med": partial(read_in_process, "med"),
    ".msh": read_msh,
    ".unv": read_unv,
    ".vtk": read_legacy_vtk,
    ".vtp": read_xml_vtk,
    ".vtu": read_xml_vtk,
}
"""Reader of each suffix."""

_SHARED_SUFFIXES = (".inp", ".dat")
_PROGRAMS: tuple[tuple[re.Pattern[str], Reader], ...] = (
    (
        re.compile(
            r"\*\s*(HEADING|NODE|ELEMENT|PART|INCLUDE|NSET|ELSET|SYSTEM|PREPRINT|ASSEMBLY|PARAMETER|NGEN)\b",
            re.IGNORECASE,
        ),
        read_abaqus,
    ),
    (
        re.compile(
            r"/[A-Z]|(NBLOCK|EBLOCK|CMBLOCK|ET|N|E|EN|MP|KEYOPT|TYPE|CSYS|\*SET|\*GET|\*DIM)\s*,", re.IGNORECASE
        ),
        read_ansys,
    ),
    (
        re.compile(
            r"(BEGIN\s+BULK|SOL\s+\w+|CEND|"
            r"(GRID|GRDSET|CORD[12][RCS]|C(QUAD|TRIA|HEXA|TETRA|PENTA)\w*|PSHELL|PSOLID|MAT1)\*?[\s,])",
            re.IGNORECASE,
        ),
        read_nastran,
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
