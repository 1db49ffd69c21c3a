"""Faces of solid cells, as surface cells."""

from dataclasses import dataclass

import numpy as np

from fedic._core import CELL_TYPES
from fedic.io._mesh_file import Block, Indices, joined
from fedic.io.mesh_parts._cells import corner_keys, groups_of

__all__ = ["SOLIDS", "boundary_faces", "faces_of"]

_MIDDLE_OF_EDGES = {3: "triangle6", 4: "quad8"}
_CORNERS_ONLY = {3: "triangle", 4: "quad"}


@dataclass(frozen=True)
class _Shape:
    """A solid: the corners of its faces, seen from outside, and those of its edges."""

    num_corners: int
    faces: tuple[tuple[int, ...], ...]
    edges: tuple[tuple[int, int], ...]


_TETRAHEDRON = _Shape(4, ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)), ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)))
_PYRAMID = _Shape(
    5,
    ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)),
)
_WEDGE = _Shape(
    6,
    ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
)
_HEXAHEDRON = _Shape(
    8,
    ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
)

_LINEAR = {"tetra": _TETRAHEDRON, "pyramid": _PYRAMID, "wedge": _WEDGE, "hexahedron": _HEXAHEDRON}
_QUADRATIC: dict[str, tuple[_Shape, dict[int, int]]] = {
    "tetra10": (_TETRAHEDRON, {}),
    "pyramid13": (_PYRAMID, {}),
    "pyramid14": (_PYRAMID, {0: 13}),
    "wedge15": (_WEDGE, {}),
    "wedge18": (_WEDGE, {2: 15, 3: 16, 4: 17}),
    "hexahedron20": (_HEXAHEDRON, {}),
    "hexahedron27": (_HEXAHEDRON, {0: 24, 1: 25, 2: 22, 3: 21, 4: 23, 5: 20}),
}
"""Solids with nodes in the middle of the edges; for each face that has one, the node in its middle."""

SOLIDS = {name: shape.num_corners for name, shape in _LINEAR.items()} | {
    name: shape.num_corners for name, (shape, _) in _QUADRATIC.items()
}
"""Solids whose faces are surface cells of fedic: number of corners by name, which is meshio's."""


def faces_of(name: str) -> list[tuple[str, list[int]]]:
    """Return the faces of a solid.

    Parameters
    ----------
    name : str
        A name of `SOLIDS`.

    Returns
    -------
    list of (str, list of int)
        Type of the surface cell of each face, and its nodes in the solid.
    """
    if name in _LINEAR:
        return [(_CORNERS_ONLY[len(face)], list(face)) for face in _LINEAR[name].faces]
    shape, centres = _QUADRATIC[name]
    middles = {frozenset(edge): shape.num_corners + index for index, edge in enumerate(shape.edges)}
    faces = []
    for index, corners in enumerate(shape.faces):
        ends = zip(corners, corners[1:] + corners[:1], strict=True)
        nodes = [*corners, *(middles[frozenset(edge)] for edge in ends)]
        if index in centres:
            faces.append(("quad9", [*nodes, centres[index]]))
        else:
            faces.append((_MIDDLE_OF_EDGES[len(corners)], nodes))
    return faces


def boundary_faces(blocks: list[Block]) -> dict[str, Indices]:
    """Return the faces on the boundary of the solids: those that belong to one solid only.

    Parameters
    ----------
    blocks : list of (str, ndarray of int, shape (m, k))
        Cells; those that are not in `SOLIDS` are ignored.

    Returns
    -------
    dict of str to ndarray of int, shape (m, k)
        Faces as surface cells by type. The corners go round anticlockwise, seen from outside.
    """
    faces = joined(
        [(cell, nodes[:, face]) for name, nodes in blocks if name in SOLIDS for cell, face in faces_of(name)]
    )
    if not faces:
        return {}
    keys = np.concatenate([corner_keys(nodes, CELL_TYPES[cell].num_corners, width=4) for cell, nodes in faces.items()])
    group = groups_of(keys)
    on_boundary = (np.bincount(group)[group] == 1) & (keys[:, 2] >= 0)
    ends = np.cumsum([len(nodes) for nodes in faces.values()])[:-1]
    kept = zip(faces.items(), np.split(on_boundary, ends), strict=True)
    return {cell: nodes[rows] for (cell, nodes), rows in kept if rows.any()}
