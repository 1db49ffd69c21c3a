"""Reader of MED files, which Salome and Code_Aster write."""

from pathlib import Path
from typing import Any

import numpy as np

from fedic.io._mesh_file import Block, Indices, MeshFile, unreadable
from fedic.io.mesh_formats.hdf._arrays import group, numbers

__all__ = ["read_med"]

_TYPES = {
    "PO1": ("vertex", 1),
    "SE2": ("line", 2),
    "SE3": ("line3", 3),
    "TR3": ("triangle", 3),
    "TR6": ("triangle6", 6),
    "TR7": ("triangle6", 7),
    "QU4": ("quad", 4),
    "QU8": ("quad8", 8),
    "QU9": ("quad9", 9),
    "TE4": ("tetra", 4),
    "T10": ("tetra10", 10),
    "PY5": ("pyramid", 5),
    "P13": ("pyramid13", 13),
    "PE6": ("wedge", 6),
    "P15": ("wedge15", 15),
    "HE8": ("hexahedron", 8),
    "H20": ("hexahedron20", 20),
    "H27": ("hexahedron27", 27),
}
_ORDER_OF_H27 = [*range(20), 24, 22, 21, 23, 20, 25, 26]
"""Place in a file of the nodes of a ``hexahedron27``; the two orders differ in the middles of the faces."""

_IGNORED = {"POG": "polygon", "POG2": "polygon of second order", "POE": "polyhedron"}


def read_med(path: Path) -> MeshFile:
    """Read a MED file with one unstructured mesh.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file. The sets are the groups; the node in the middle of a ``TR7`` is left out.

    Raises
    ------
    MeshError
        If the file is damaged or holds several meshes.
    """
    import h5py

    try:
        with h5py.File(path, "r") as file:
            return _read(file)
    except ValueError as error:
        raise unreadable(path, str(error)) from error
    except (OSError, KeyError, TypeError, RuntimeError) as error:
        raise unreadable(path, "the file is damaged, or is no MED file") from error


def _read(file: Any) -> MeshFile:
    meshes = group(file, "ENS_MAA")
    if len(meshes) != 1:
        raise ValueError(f"it holds {len(meshes)} meshes ({', '.join(meshes)}); save one of them alone")
    (name,) = meshes
    mesh = group(meshes, name)
    families = group(file, f"FAS/{name}") if name in file.get("FAS", {}) else {}
    if "NOE" not in mesh:  # newer files hold the mesh at each time
        steps = list(mesh)
        if not steps:
            raise ValueError("its mesh is empty")
        mesh = group(mesh, steps[0])
    nodes = group(mesh, "NOE")
    coordinates = numbers(nodes, "COO").ravel()
    count = int(group(nodes, "COO").attrs["NBR"])
    if count < 1 or len(coordinates) not in (2 * count, 3 * count):
        raise ValueError(f"it holds {len(coordinates)} coordinates for {count} nodes")
    contents = MeshFile(coordinates.reshape(-1, count).T.astype(np.float64), [])
    contents.node_labels = _labels(nodes, count)
    tags, labels = [], []
    cells = group(mesh, "MAI") if "MAI" in mesh else {}
    for code in cells:
        block, tag = _block(code, group(cells, code))
        contents.blocks.append(block)
        tags.append(tag)
        labels.append(_labels(group(cells, code), len(block[1])))
    known = [each for each in labels if each is not None]
    contents.cell_labels = known if len(known) == len(labels) else None
    for label, groups in _groups(families, "ELEME"):
        for each in groups:
            members = contents.cell_sets.setdefault(each, [np.empty(0, dtype=np.int64)] * len(tags))
            found = [np.flatnonzero(tag == label) for tag in tags]
            contents.cell_sets[each] = [np.union1d(old, new) for old, new in zip(members, found, strict=True)]
    of_nodes = numbers(nodes, "FAM").ravel() if "FAM" in nodes else np.zeros(count, dtype=np.int64)
    for label, groups in _groups(families, "NOEUD"):
        for each in groups:
            before = contents.node_sets.get(each, np.empty(0, dtype=np.int64))
            contents.node_sets[each] = np.union1d(before, np.flatnonzero(of_nodes == label))
    return contents


def _labels(entities: Any, count: int) -> Indices | None:
    """Return the numbers of nodes or cells, if the file has them."""
    labels = numbers(entities, "NUM").ravel().astype(np.int64) if "NUM" in entities else np.empty(0, dtype=np.int64)
    return labels if len(labels) == count else None


def _block(code: str, cells: Any) -> tuple[Block, Indices]:
    """Return the cells of a type, and the family of each."""
    if code not in _TYPES:
        empty = np.empty((0, 1), dtype=np.int64)
        if code in ("POG", "POG2"):
            raise ValueError(f"it holds cells of type {_IGNORED[code]}; save triangles and quadrilaterals")
        return (_IGNORED.get(code, f"MED type {code}"), empty), empty[:, 0]
    name, size = _TYPES[code]
    connectivity = numbers(cells, "NOD").ravel()
    if len(connectivity) % size:
        raise ValueError(f"its {code} cells have {len(connectivity)} nodes, no multiple of {size}")
    nodes = connectivity.reshape(size, -1).T.astype(np.int64) - 1
    tags = numbers(cells, "FAM").ravel().astype(np.int64) if "FAM" in cells else np.zeros(len(nodes), dtype=np.int64)
    if len(tags) != len(nodes):
        raise ValueError(f"it gives {len(tags)} families for {len(nodes)} {code} cells")
    if code == "TR7":
        nodes = nodes[:, :6]
    elif code == "H27":
        nodes = nodes[:, _ORDER_OF_H27]
    return (name, nodes), tags


def _groups(families: Any, kind: str) -> list[tuple[int, list[str]]]:
    """Return the number of each family and the names of its groups."""
    found = []
    for family in families.get(kind, {}).values() if kind in families else ():
        if "GRO" in family:
            rows = numbers(group(family, "GRO"), "NOM")
            names = [bytes(np.asarray(row, dtype=np.uint8)).partition(b"\0")[0] for row in rows]
            found.append((int(family.attrs["NUM"]), [name.decode("utf-8", "replace").strip() for name in names]))
    return found
