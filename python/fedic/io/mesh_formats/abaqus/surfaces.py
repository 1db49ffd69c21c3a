"""Named surfaces of Abaqus: faces of volume elements, and shells."""

from collections import Counter
from collections.abc import Iterable, Mapping

import numpy as np

from fedic._core import CELL_TYPES
from fedic.io._mesh_file import Indices
from fedic.io.mesh_formats._labelled_mesh import Element, Numbering
from fedic.io.mesh_formats.abaqus.blocks import Block
from fedic.io.mesh_formats.abaqus.container import SurfaceBlock
from fedic.io.mesh_formats.abaqus.sets import SetResolver
from fedic.io.mesh_parts import SOLIDS, faces_of

__all__ = ["read_surface", "surface_cells"]

_Face = tuple[str, tuple[int, ...]]


def read_surface(block: Block, outer: bool) -> SurfaceBlock | None:
    """Return the surface of a ``*SURFACE`` block that is made of element faces; None for any other.

    Parameters
    ----------
    block : Block
        The block.
    outer : bool
        True in the assembly.

    Returns
    -------
    SurfaceBlock or None
        The surface.
    """
    parameters = block.parameters
    if parameters.get("TYPE", "ELEMENT").upper() != "ELEMENT" or "COMBINE" in parameters or "NAME" not in parameters:
        return None
    faces = []
    for line in block.data:
        name, face, *_ = [*line.items(), "", ""]
        faces.append((name.strip('"'), face.upper()))
    return SurfaceBlock(parameters["NAME"], block.line, faces, outer)


def surface_cells(resolver: SetResolver, surface: SurfaceBlock, nodes: Numbering) -> list[tuple[str, Indices]]:
    """Return the surface cells of a named surface as far as it lies in a part.

    Parameters
    ----------
    resolver : SetResolver
        The part with its sets.
    surface : SurfaceBlock
        The surface.
    nodes : Numbering
        The nodes of the part.

    Returns
    -------
    list of (str, ndarray of int, shape (m, k))
        Cells by type, with indices of nodes; edges of plane elements are left out.
    """
    elements = resolver.mesh.elements
    found: dict[_Face, None] = {}
    counts = {} if all(side for _, side in surface.faces) else _face_counts(elements.values())
    for name, side in surface.faces:
        members = [elements[label] for label in resolver.element_labels(name, surface.outer).tolist()]
        faces = [_face(element, side) for element in members] if side else _free_faces(members, counts)
        found.update(dict.fromkeys(face for face in faces if face is not None))
    cells: dict[str, list[tuple[int, ...]]] = {}
    for cell, labels in found:
        cells.setdefault(cell, []).append(labels)
    blocks = []
    for cell, rows in cells.items():
        places, known = nodes.places(np.array(rows, dtype=np.int64))
        if known.all():
            blocks.append((cell, places))
    return blocks


def _face(element: Element, side: str) -> _Face | None:
    """Return one face of a volume element, or a shell as its own face."""
    if element.cell in CELL_TYPES:
        return (element.cell, element.nodes) if side in ("SPOS", "SNEG") else None
    faces = _faces(element)
    if side[:1] != "S" or not side[1:].isdigit() or not 1 <= int(side[1:]) <= len(faces):
        return None
    return faces[int(side[1:]) - 1]


def _free_faces(members: list[Element], counts: Mapping[frozenset[int], int]) -> list[_Face]:
    """Return the outer faces of volume elements, and shells themselves."""
    found: list[_Face] = []
    for element in members:
        if element.cell in CELL_TYPES:
            found.append((element.cell, element.nodes))
        found += [(cell, labels) for cell, labels in _faces(element) if counts[frozenset(labels)] == 1]
    return found


def _face_counts(elements: Iterable[Element]) -> Counter[frozenset[int]]:
    """Return how many volume elements have each face, by its nodes."""
    return Counter(frozenset(labels) for element in elements for _, labels in _faces(element))


def _faces(element: Element) -> list[_Face]:
    """Return the faces of a volume element, numbered as Abaqus numbers them; none of another element."""
    faces = faces_of(element.cell) if element.cell in SOLIDS else []
    return [(cell, tuple(element.nodes[place] for place in places)) for cell, places in faces]
