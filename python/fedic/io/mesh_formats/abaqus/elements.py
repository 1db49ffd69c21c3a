"""Element types of Abaqus."""

import re
from typing import NamedTuple

from fedic._core import CELL_TYPES

__all__ = ["ElementType", "element_type"]

_CELL_NAMES = {suffix: name for name, cell in CELL_TYPES.items() for suffix in cell.abaqus_suffixes}
_SUFFIXES = "|".join(sorted(_CELL_NAMES, key=len, reverse=True))
_SURFACE = re.compile(rf"(?:CPS|CPE|CPEG|CAX|CGAX|M3D|SFM3D|R3D|S|STRI|DS|DC2D|DCAX|AC2D|ACAX)({_SUFFIXES})(?!\d)")
_VOLUME = re.compile(r"(?:C3D|DC3D|DCC3D|AC3D|EC3D|Q3D|CSS|SC)(4|5|6|8|10|15|20)(?![\dV])")
_VOLUMES = {
    "4": ("tetra", 4),
    "5": ("pyramid", 5),
    "6": ("wedge", 6),
    "8": ("hexahedron", 8),
    "10": ("tetra10", 10),
    "15": ("wedge15", 15),
    "20": ("hexahedron20", 20),
}
_LINE2 = re.compile(r"(?:B[23][13]|PIPE[23]1|T[23]D2|R2D2|RAX2|RB[23]D2|SAX1|DSAX1|MAX1|SFMAX1|DC1D2)(?!\d)")
_BEAM3 = re.compile(r"(?:B[23]2|PIPE[23]2|SAX2|DSAX2|MAX2|SFMAX2)(?!\d)")
_TRUSS3 = re.compile(r"(?:T[23]D3|DC1D3)(?!\d)")


class ElementType(NamedTuple):
    """What becomes of an element type.

    Attributes
    ----------
    cell : str
        Cell type, as in `MeshFile`.
    nodes : tuple of int
        For each node of the cell the index of the node in the file.
    apart : bool
        True for rigid elements, which are no part of a deformable specimen.
    more : bool
        True if further nodes may follow, such as those that orient a beam.
    """

    cell: str
    nodes: tuple[int, ...]
    apart: bool = False
    more: bool = False


def element_type(name: str) -> ElementType | None:
    """Return the element type of a name.

    Parameters
    ----------
    name : str
        Such as ``"CPS4R"``.

    Returns
    -------
    ElementType or None
        None for types that fedic does not use: springs, masses, connectors, user elements, ...
    """
    name = name.upper()
    if surface := _SURFACE.match(name):
        cell = _CELL_NAMES[surface[1]]
        return ElementType(cell, tuple(range(CELL_TYPES[cell].num_nodes)), apart=name.startswith("R3D"))
    if volume := _VOLUME.match(name):
        cell, count = _VOLUMES[volume[1]]
        return ElementType(cell, tuple(range(count)))
    if _LINE2.match(name):
        return ElementType("line", (0, 1), more=True)
    if _BEAM3.match(name):
        return ElementType("line3", (0, 2, 1), more=True)
    if _TRUSS3.match(name):
        return ElementType("line3", (0, 1, 2))
    return None
