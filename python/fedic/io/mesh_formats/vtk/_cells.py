"""Cells of VTK's data sets."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES
from fedic.io._mesh_file import Indices, MeshFile
from fedic.io.mesh_formats._set_fields import SET_PREFIX

__all__ = ["Piece", "as_mesh_file"]

_STRIP, _POLYGON = 6, 7
_NUM_TYPES = 256
_FIXED = {
    1: ("vertex", 1),
    3: ("line", 2),
    8: ("quad", 4),
    10: ("tetra", 4),
    11: ("hexahedron", 8),
    12: ("hexahedron", 8),
    13: ("wedge", 6),
    14: ("pyramid", 5),
    21: ("line3", 3),
    24: ("tetra10", 10),
    25: ("hexahedron20", 20),
    26: ("wedge15", 15),
    27: ("pyramid13", 13),
    29: ("hexahedron27", 27),
    30: ("quad6", 6),
    32: ("wedge18", 18),
    34: ("triangle7", 7),
} | {cell.vtk_type: (name, cell.num_nodes) for name, cell in CELL_TYPES.items()}
"""Types of cells with a fixed number of nodes: name and number."""

_VARIABLE = {
    **{code: {3: "triangle", 6: "triangle6", 7: "triangle7"} for code in (62, 69)},
    **{code: {4: "quad", 9: "quad9"} for code in (63, 70)},
    4: {2: "line"},
    7: {3: "triangle", 4: "quad"},
    71: {4: "tetra", 10: "tetra10"},
    72: {8: "hexahedron"},
    73: {6: "wedge"},
    74: {5: "pyramid"},
    76: {3: "triangle"},
    77: {4: "quad"},
}
"""Types of cells whose number of nodes gives the order: names by that number."""

_OTHERS = {
    2: "points",
    4: "poly-line",
    35: "line4",
    42: "polyhedron",
    62: "triangle of higher order",
    63: "quad of higher order",
    68: "Lagrange curve",
    69: "triangle of higher order",
    70: "quad of higher order",
    76: "triangle of Bezier",
    77: "quad of Bezier",
}

_PIXEL, _VOXEL = 8, 11
_ORDERS = {_PIXEL: (0, 1, 3, 2), _VOXEL: (0, 1, 3, 2, 4, 5, 7, 6)}


@dataclass
class Piece:
    """The nodes, cells and sets of a data set, or of a piece of it.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        Nodes.
    types : ndarray of int, shape (m,)
        VTK's number of the type of each cell.
    ends : ndarray of int, shape (m,)
        Place in `connectivity` after the last node of each cell.
    connectivity : ndarray of int
        Nodes of the cells, one after the other.
    point_sets, cell_sets : dict of str to ndarray, shape (n,) or (m,)
        Fields that are zero outside a set.
    """

    points: NDArray[np.float64]
    types: Indices
    ends: Indices
    connectivity: Indices
    point_sets: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    cell_sets: dict[str, NDArray[np.float64]] = field(default_factory=dict)


def as_mesh_file(pieces: list[Piece]) -> MeshFile:
    """Join pieces to the contents of one file.

    Parameters
    ----------
    pieces : list of Piece
        The pieces.

    Returns
    -------
    MeshFile
        Polygons of three and four nodes, strips of triangles, pixels, and Lagrange cells of first and second order are
        cells of fedic; a triangle with a node in its middle loses it.

    Raises
    ------
    ValueError
        If the cells and their nodes do not fit together.
    """
    starts = np.cumsum([0, *(len(piece.points) for piece in pieces)])
    contents = MeshFile(np.concatenate([np.empty((0, 3)), *(piece.points for piece in pieces)]), [])
    for piece, start in zip(pieces, starts, strict=False):
        for name, values in piece.point_sets.items():
            if len(values) != len(piece.points):
                raise ValueError(f"the field {SET_PREFIX}{name} has {len(values)} values for {len(piece.points)} nodes")
            members = contents.node_sets.get(name, np.empty(0, dtype=np.int64))
            contents.node_sets[name] = np.concatenate([members, start + np.flatnonzero(values)])
        for name, values in piece.cell_sets.items():
            if len(values) != len(piece.types):
                raise ValueError(f"the field {SET_PREFIX}{name} has {len(values)} values for {len(piece.types)} cells")
        for name, nodes, source in _blocks(piece):
            contents.blocks.append((name, nodes + start))
            for each, values in piece.cell_sets.items():
                contents.cell_sets.setdefault(each, [])
                missing = len(contents.blocks) - 1 - len(contents.cell_sets[each])
                contents.cell_sets[each] += [np.empty(0, dtype=np.int64)] * missing
                contents.cell_sets[each].append(np.flatnonzero(values[source]))
    return contents


def _blocks(piece: Piece) -> list[tuple[str, Indices, Indices]]:
    """Return the name, the nodes and the places in the piece of the cells of each type and number of nodes."""
    first = np.concatenate([np.zeros(1, dtype=np.int64), piece.ends[:-1]])
    sizes = piece.ends - first
    if len(piece.ends) != len(piece.types):
        raise ValueError(f"there are {len(piece.types)} types of cells for {len(piece.ends)} cells")
    if len(sizes) and (sizes.min() < 0 or piece.ends[-1] > len(piece.connectivity)):
        raise ValueError("the cells have more nodes than the list of their nodes holds; the file is damaged")
    if len(sizes) and not 0 <= piece.types.min() <= piece.types.max() < _NUM_TYPES:
        raise ValueError("a type of cells is no number from 0 to 255; the file is damaged")
    # In the order in which the file uses them.
    keys, places = np.unique(piece.types + _NUM_TYPES * sizes, return_index=True)
    blocks = []
    for key in keys[np.argsort(places)]:
        code, size = int(key % _NUM_TYPES), int(key // _NUM_TYPES)
        source = np.flatnonzero((piece.types == code) & (sizes == size))
        nodes = piece.connectivity[np.add.outer(first[source], np.arange(size))]
        if code == _STRIP and size >= 3:
            triangles = [nodes[:, [i, i + 1 + i % 2, i + 2 - i % 2]] for i in range(size - 2)]
            blocks.append(("triangle", np.concatenate(triangles), np.tile(source, size - 2)))
            continue
        name = _name(code, size)
        if code in _ORDERS:
            nodes = nodes[:, _ORDERS[code]]
        if name == "triangle7":  # the node in the middle adds nothing where the edges give the shape
            name, nodes = "triangle6", nodes[:, :6]
        blocks.append((name, nodes, source))
    return blocks


def _name(code: int, size: int) -> str:
    if code in _FIXED:
        name, number = _FIXED[code]
        if size != number:
            raise ValueError(f"a {name} has {size} nodes, not {number}; the file is damaged")
        return name
    if size in _VARIABLE.get(code, {}):
        return _VARIABLE[code][size]
    if code == _POLYGON:
        return f"polygon of {size} nodes"
    return _OTHERS.get(code, f"VTK type {code}")
