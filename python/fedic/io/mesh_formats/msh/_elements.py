"""Element types of Gmsh."""

from dataclasses import dataclass

__all__ = ["ELEMENTS", "Element"]


@dataclass(frozen=True)
class Element:
    """A type of elements.

    Attributes
    ----------
    name : str
        Name of the cell type, meshio's for those that fedic does not measure on.
    dimension : int
        0 to 3.
    num_nodes : int
        Number of nodes.
    order : tuple of int
        Place in Gmsh's order of each node in the order of the cell type; empty if they are the same.
    """

    name: str
    dimension: int
    num_nodes: int
    order: tuple[int, ...] = ()


_HEXAHEDRON_EDGES = (0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15)
_WEDGE_EDGES = (0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11)
_PYRAMID_EDGES = (0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12)

ELEMENTS = {
    1: Element("line", 1, 2),
    2: Element("triangle", 2, 3),
    3: Element("quad", 2, 4),
    4: Element("tetra", 3, 4),
    5: Element("hexahedron", 3, 8),
    6: Element("wedge", 3, 6),
    7: Element("pyramid", 3, 5),
    8: Element("line3", 1, 3),
    9: Element("triangle6", 2, 6),
    10: Element("quad9", 2, 9),
    11: Element("tetra10", 3, 10, (0, 1, 2, 3, 4, 5, 6, 7, 9, 8)),
    12: Element("hexahedron27", 3, 27, (*_HEXAHEDRON_EDGES, 22, 23, 21, 24, 20, 25, 26)),
    13: Element("wedge18", 3, 18, (*_WEDGE_EDGES, 15, 17, 16)),
    14: Element("pyramid14", 3, 14, (*_PYRAMID_EDGES, 13)),
    15: Element("vertex", 0, 1),
    16: Element("quad8", 2, 8),
    17: Element("hexahedron20", 3, 20, _HEXAHEDRON_EDGES),
    18: Element("wedge15", 3, 15, _WEDGE_EDGES),
    19: Element("pyramid13", 3, 13, _PYRAMID_EDGES),
    20: Element("triangle9", 2, 9),
    21: Element("triangle10", 2, 10),
    22: Element("triangle12", 2, 12),
    23: Element("triangle15", 2, 15),
    24: Element("triangle15 (incomplete)", 2, 15),
    25: Element("triangle21", 2, 21),
    26: Element("line4", 1, 4),
    27: Element("line5", 1, 5),
    28: Element("line6", 1, 6),
    29: Element("tetra20", 3, 20),
    30: Element("tetra35", 3, 35),
    31: Element("tetra56", 3, 56),
    36: Element("quad16", 2, 16),
    37: Element("quad25", 2, 25),
    38: Element("quad36", 2, 36),
    92: Element("hexahedron64", 3, 64),
    93: Element("hexahedron125", 3, 125),
}
"""The element types by their number in the files."""
