"""Which finite element program wrote a mesh file."""

import re
from collections.abc import Callable
from pathlib import Path

from fedic.io._mesh_file import MeshFile
from fedic.io._text import first_lines
from fedic.io.abaqus import read_abaqus
from fedic.io.ansys import read_ansys
from fedic.io.nastran import read_nastran
from fedic.io.unv import read_unv

__all__ = ["PROGRAM_SUFFIXES", "program_reader"]

_Reader = Callable[[Path], MeshFile]
_BY_SUFFIX: dict[str, _Reader] = {
    ".bdf": read_nastran,
    ".nas": read_nastran,
    ".fem": read_nastran,
    ".cdb": read_ansys,
    ".unv": read_unv,
}
_BY_CONTENTS = (".inp", ".dat")
PROGRAM_SUFFIXES = (*_BY_SUFFIX, *_BY_CONTENTS)
"""Suffixes of the files of finite element programs."""
_ABAQUS = re.compile(
    r"\*\s*(HEADING|NODE|ELEMENT|PART|INCLUDE|NSET|ELSET|SYSTEM|PREPRINT|ASSEMBLY|PARAMETER|NGEN)\b", re.IGNORECASE
)
_ANSYS = re.compile(
    r"/[A-Z]|(NBLOCK|EBLOCK|CMBLOCK|ET|N|E|EN|MP|KEYOPT|TYPE|CSYS|\*SET|\*GET|\*DIM)\s*,", re.IGNORECASE
)
_NASTRAN = re.compile(
    r"(BEGIN\s+BULK|SOL\s+\w+|CEND|(GRID|GRDSET|CORD[12][RCS]|C(QUAD|TRIA|HEXA|TETRA|PENTA)\w*|PSHELL|PSOLID|MAT1)\*?[\s,])",
    re.IGNORECASE,
)


def program_reader(path: Path) -> Callable[[Path], MeshFile] | None:
    """Return the reader of the finite element program that wrote a file.

    Parameters
    ----------
    path : Path
        The file. Several programs use ``.inp`` and ``.dat``: there the contents tell.

    Returns
    -------
    callable or None
        None for all other mesh files.

    Raises
    ------
    MeshError
        If the file cannot be read.
    """
    suffix = path.suffix.lower()
    if suffix not in _BY_CONTENTS:
        return _BY_SUFFIX.get(suffix)
    for line in first_lines(path):
        text = line.strip()
        for pattern, reader in ((_ABAQUS, read_abaqus), (_ANSYS, read_ansys), (_NASTRAN, read_nastran)):
            if pattern.match(text):
                return reader
    return read_abaqus if suffix == ".inp" else None
