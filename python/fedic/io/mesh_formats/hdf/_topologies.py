"""Cell types of XDMF."""

import numpy as np
from numpy.typing import NDArray

from fedic.io._mesh_file import Block

__all__ = ["OF_NODES", "SHORT", "TOPOLOGIES", "mixed_blocks"]

TOPOLOGIES = {
    "triangle": ("triangle", 3, 0x4),
    "quadrilateral": ("quad", 4, 0x5),
    "tetrahedron": ("tetra", 4, 0x6),
    "pyramid": ("pyramid", 5, 0x7),
    "wedge": ("wedge", 6, 0x8),
    "hexahedron": ("hexahedron", 8, 0x9),
    "edge_3": ("line3", 3, 0x22),
    "quadrilateral_9": ("quad9", 9, 0x23),
    "triangle_6": ("triangle6", 6, 0x24),
    "quadrilateral_8": ("quad8", 8, 0x25),
    "tetrahedron_10": ("tetra10", 10, 0x26),
    "pyramid_13": ("pyramid13", 13, 0x27),
    "wedge_15": ("wedge15", 15, 0x28),
    "wedge_18": ("wedge18", 18, 0x29),
    "hexahedron_20": ("hexahedron20", 20, 0x30),
    "hexahedron_27": ("hexahedron27", 27, 0x32),
}
"""Topologies: name and number of nodes of the cells, and number in a mixed topology."""

SHORT = {"tri": "triangle", "quad": "quadrilateral", "tet": "tetrahedron", "pyr": "pyramid", "hex": "hexahedron"}
OF_NODES = {"polyvertex": {1: "vertex"}, "polyline": {2: "line"}, "polygon": {3: "triangle", 4: "quad"}}
_MIXED_OF_NODES = {1: "polyvertex", 2: "polyline", 3: "polygon"}


def mixed_blocks(values: NDArray[np.int64]) -> tuple[list[Block], NDArray[np.int64]]:
    """Return the cells of a mixed topology by type.

    Parameters
    ----------
    values : ndarray of int
        The numbers of the topology.

    Returns
    -------
    blocks : list of (str, ndarray of int, shape (m, k))
        The cells of each type.
    order : ndarray of int
        The number in the file of each cell, block after block.

    Raises
    ------
    ValueError
        If a cell is of an unknown type, or the last one is incomplete.
    """
    codes = {code: (name, size) for name, size, code in TOPOLOGIES.values()}
    items = values.tolist()
    found: dict[tuple[str, int], tuple[list[int], list[int]]] = {}
    place = number = 0
    while place < len(items):
        code = items[place]
        place += 1
        if code in _MIXED_OF_NODES:
            kind = _MIXED_OF_NODES[code]
            size = items[place] if place < len(items) else 0
            name = OF_NODES[kind].get(size, f"{kind} of {size} nodes")
            place += 1
        elif code in codes:
            name, size = codes[code]
        else:
            raise ValueError(f"cells of number {code} in a mixed topology are not read")
        if size < 1 or place + size > len(items):
            raise ValueError("the mixed topology ends before the nodes of its last cell; the file is damaged")
        starts, places = found.setdefault((name, size), ([], []))
        starts.append(place)
        places.append(number)
        place += size
        number += 1
    blocks = [
        (name, values[np.add.outer(np.array(starts, dtype=np.int64), np.arange(size))])
        for (name, size), (starts, _) in found.items()
    ]
    order = [np.array(places, dtype=np.int64) for _, places in found.values()]
    return blocks, np.concatenate([np.empty(0, dtype=np.int64), *order])
