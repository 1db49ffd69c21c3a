"""Element types of Ansys, and cells with repeated or missing nodes."""

from collections.abc import Sequence

from fedic.io.mesh_formats._labelled_mesh import Element

__all__ = ["MESH_ONLY", "element_of", "is_known"]

MESH_ONLY = {4: 182, 5: 2, 6: 182, 7: 183, 8: 285, 9: 187, 10: 185, 11: 186}
"""For the first option of ``MESH200`` a type of the same shape."""

_QUAD4 = {13, 25, 28, 41, 42, 43, 55, 57, 63, 67, 75, 131, 143, 157, 162, 163, 181, 182, 212, 222, 292}
_QUAD8 = {53, 77, 78, 82, 83, 91, 93, 99, 121, 132, 183, 213, 223, 230, 233, 238, 281, 293}
_TRIANGLE6 = {2, 35}
_HEXAHEDRON8 = {5, 45, 46, 62, 64, 65, 69, 70, 96, 97, 164, 185, 190, 215, 225, 278}
_HEXAHEDRON20 = {89, 90, 95, 117, 122, 186, 191, 216, 226, 231, 236, 279}
_TETRA10 = {87, 92, 98, 119, 123, 168, 187, 217, 227, 232, 237, 291}
_TETRA4 = {72, 285}
_LINE2 = {1, 3, 4, 8, 10, 180, 188}
_CORNERS = {
    **dict.fromkeys(_QUAD4 | _QUAD8, 4),
    **dict.fromkeys(_TRIANGLE6, 3),
    **dict.fromkeys(_HEXAHEDRON8 | _HEXAHEDRON20, 8),
    **dict.fromkeys(_TETRA10 | _TETRA4, 4),
    **dict.fromkeys(_LINE2, 2),
}
_NODES = {
    **_CORNERS,
    **dict.fromkeys(_QUAD8, 8),
    **dict.fromkeys(_TRIANGLE6, 6),
    **dict.fromkeys(_HEXAHEDRON20, 20),
    **dict.fromkeys(_TETRA10, 10),
}
# Cell types, with the corners and the nodes in the middle of edges that a shape keeps of a quadrilateral or hexahedron.
_QUAD = ("quad", "quad8", (0, 1, 2, 3), (4, 5, 6, 7))
_TRIANGLE_OF_QUAD = ("triangle", "triangle6", (0, 1, 2), (4, 5, 7))
_TRIANGLE = ("triangle", "triangle6", (0, 1, 2), (3, 4, 5))
_HEXAHEDRON = ("hexahedron", "hexahedron20", tuple(range(8)), tuple(range(8, 20)))
_WEDGE = ("wedge", "wedge15", (0, 1, 2, 4, 5, 6), (8, 9, 11, 12, 13, 15, 16, 17, 18))
_PYRAMID = ("pyramid", "pyramid13", (0, 1, 2, 3, 4), (8, 9, 10, 11, 16, 17, 18, 19))
_TETRA_OF_HEXAHEDRON = ("tetra", "tetra10", (0, 1, 2, 4), (8, 9, 11, 16, 17, 18))
_TETRA = ("tetra", "tetra10", (0, 1, 2, 3), tuple(range(4, 10)))


def is_known(routine: int) -> bool:
    """Return whether fedic uses the elements of a type.

    Parameters
    ----------
    routine : int
        The number in the name of the type: 182 of ``PLANE182``.

    Returns
    -------
    bool
        True for plane elements, shells, solids, and bars.
    """
    return routine in _NODES


def element_of(routine: int, given: Sequence[int]) -> Element:
    """Return the element of a known type.

    Parameters
    ----------
    routine : int
        The number in the name of the type: 182 of ``PLANE182``.
    given : sequence of int
        Numbers of its nodes; zero where there is none.

    Returns
    -------
    Element
        A triangle if the third and fourth node of a quadrilateral are one; wedges, pyramids and tetrahedra likewise.

    Raises
    ------
    ValueError
        If nodes are missing, or some but not all of those in the middle of edges.
    """
    corners, most = _CORNERS[routine], _NODES[routine]
    nodes = list(given[:most])
    if routine in _LINE2:
        return Element("line", (*_present(nodes[:2], 2),))
    if routine in _QUAD8 and len(nodes) == 6:
        nodes = [*nodes[:3], nodes[2], *nodes[3:5], nodes[2], nodes[5]]
    if corners == 4 and len(nodes) == 3 and routine in _QUAD4 | _QUAD8:
        nodes.append(nodes[2])
    _present(nodes[:corners], corners)
    linear, quadratic, first, middle = _shape(routine, nodes)
    nodes += [0] * (most - len(nodes))
    mids = [nodes[place] for place in middle if place < most]
    kept = tuple(nodes[place] for place in first)
    if not any(mids):
        return Element(linear, kept)
    if not all(mids):
        raise ValueError(f"it has {sum(map(bool, mids))} of {len(mids)} nodes in the middle of edges, not all or none")
    return Element(quadratic, (*kept, *mids))


def _shape(routine: int, nodes: list[int]) -> tuple[str, str, tuple[int, ...], tuple[int, ...]]:
    if routine in _TRIANGLE6:
        return _TRIANGLE
    if routine in _TETRA10 | _TETRA4:
        return _TETRA
    if routine in _QUAD4 | _QUAD8:
        return _TRIANGLE_OF_QUAD if nodes[2] == nodes[3] else _QUAD
    top = nodes[4:8]
    if len(set(top)) == 1:
        return _TETRA_OF_HEXAHEDRON if nodes[2] == nodes[3] else _PYRAMID
    return _WEDGE if nodes[2] == nodes[3] and nodes[6] == nodes[7] else _HEXAHEDRON


def _present(nodes: list[int], count: int) -> list[int]:
    if len(nodes) < count or not all(nodes):
        raise ValueError(f"it has {sum(map(bool, nodes))} nodes at its corners, not {count}")
    return nodes
