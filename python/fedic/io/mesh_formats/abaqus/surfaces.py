"""Named surfaces of Abaqus: faces of volume elements, and shells."""

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
    for name, side in surface.faces:
        members = [elements[label] for label in resolver.element_labels(name, surface.outer).tolist()]
        faces = _free_faces(resolver, members) if not side else [_face(element, side) for element in members]
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
    # The faces are numbered as Abaqus numbers them.
    faces = faces_of(element.cell) if element.cell in SOLIDS else []
    if side[:1] != "S" or not side[1:].isdigit() or not 1 <= int(side[1:]) <= len(faces):
        return None
    cell, places = faces[int(side[1:]) - 1]
    return cell, tuple(element.nodes[place] for place in places)


def _free_faces(resolver: SetResolver, members: list[Element]) -> list[_Face]:
    """Return the outer faces of volume elements, and shells themselves."""
    shared: dict[frozenset[int], int] = {}
    for element in resolver.mesh.elements.values():
        for _, places in faces_of(element.cell) if element.cell in SOLIDS else []:
            key = frozenset(element.nodes[place] for place in places)
            shared[key] = shared.get(key, 0) + 1
    found: list[_Face] = []
    for element in members:
        if element.cell in CELL_TYPES:
            found.append((element.cell, element.nodes))
        for cell, places in faces_of(element.cell) if element.cell in SOLIDS else []:
            labels = tuple(element.nodes[place] for place in places)
            if shared[frozenset(labels)] == 1:
                found.append((cell, labels))
    return found
