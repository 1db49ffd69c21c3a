"""Elements of universal files, by the number of their descriptor."""

from fedic.io.mesh_formats._labelled_mesh import Element

__all__ = ["BEAMS", "element_of"]

BEAMS = {11, 21, 22, 23, 24}
"""Descriptors of rods and beams, whose entry has one line more."""
_SURFACES = {
    3: ("triangle", (0, 1, 2)),
    6: ("triangle6", (0, 2, 4, 1, 3, 5)),
    4: ("quad", (0, 1, 2, 3)),
    8: ("quad8", (0, 2, 4, 6, 1, 3, 5, 7)),
}
"""Cell type and the places of its nodes by number of nodes; nodes go round the edge in the file."""
_SOLIDS = {
    4: ("tetra", tuple(range(4))),
    5: ("pyramid", tuple(range(5))),
    6: ("wedge", tuple(range(6))),
    8: ("hexahedron", tuple(range(8))),
    10: ("tetra10", (0, 2, 4, 9, 1, 3, 5, 6, 7, 8)),
    15: ("wedge15", (0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8)),
    20: ("hexahedron20", (0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11)),
}
_LINES = {2: ("line", (0, 1)), 3: ("line3", (0, 2, 1))}
_SURFACE_FAMILIES = range(41, 100)
"""Plane stress, plane strain, plates, membranes, axisymmetric solids and thin shells."""
_SOLID_FAMILIES = range(101, 120)
"""Thick shells and solids."""


def element_of(descriptor: int, nodes: list[int]) -> Element | None:
    """Return the element of a descriptor.

    Parameters
    ----------
    descriptor : int
        The number of the element type.
    nodes : list of int
        Numbers of its nodes in the order of the file.

    Returns
    -------
    Element or None
        None for element types that fedic does not use.
    """
    if descriptor in BEAMS:
        table = _LINES
    elif descriptor in _SURFACE_FAMILIES:
        table = _SURFACES
    elif descriptor in _SOLID_FAMILIES:
        table = _SOLIDS
    else:
        return None
    if len(nodes) not in table:
        return None
    cell, places = table[len(nodes)]
    return Element(cell, tuple(nodes[place] for place in places))
