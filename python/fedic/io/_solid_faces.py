"""Faces of volume elements, numbered as Abaqus numbers them."""

__all__ = ["face_nodes"]

_CORNERS = {
    "tetra": ("012", "031", "132", "230"),
    "pyramid": ("0123", "041", "142", "243", "340"),
    "wedge": ("012", "354", "0341", "1452", "2530"),
    "hexahedron": ("0123", "4765", "0451", "1562", "2673", "3740"),
}
_EDGES = {
    "tetra": ("01", "12", "20", "03", "13", "23"),
    "pyramid": ("01", "12", "23", "30", "04", "14", "24", "34"),
    "wedge": ("01", "12", "20", "34", "45", "53", "03", "14", "25"),
    "hexahedron": ("01", "12", "23", "30", "45", "56", "67", "74", "04", "15", "26", "37"),
}
_NUM_CORNERS = {"tetra": 4, "pyramid": 5, "wedge": 6, "hexahedron": 8}
_LINEAR = {3: "triangle", 4: "quad"}
_QUADRATIC = {3: "triangle6", 4: "quad8"}


def face_nodes(cell: str) -> list[tuple[str, list[int]]]:
    """Return the faces of a volume element.

    Parameters
    ----------
    cell : str
        Name of the element as in meshio: ``"tetra"``, ``"hexahedron20"``, ...

    Returns
    -------
    list of (str, list of int)
        Surface cell type and nodes of each face, indices in the element; empty if the element is not known.
    """
    shape = cell.rstrip("0123456789")
    if shape not in _CORNERS:
        return []
    corners, edges = _NUM_CORNERS[shape], _EDGES[shape]
    if cell == shape:
        return [(_LINEAR[len(face)], [int(node) for node in face]) for face in _CORNERS[shape]]
    if cell != f"{shape}{corners + len(edges)}":
        return []
    middle = {frozenset(edge): corners + index for index, edge in enumerate(edges)}
    faces = []
    for face in _CORNERS[shape]:
        mids = [middle[frozenset((a, b))] for a, b in zip(face, face[1:] + face[0], strict=True)]
        faces.append((_QUADRATIC[len(face)], [int(node) for node in face] + mids))
    return faces
