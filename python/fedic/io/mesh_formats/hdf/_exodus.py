"""Reader of Exodus files, which Cubit and the codes of Sandia write."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from fedic._core import CELL_TYPES
from fedic.errors import MeshError
from fedic.io._mesh_file import Indices, MeshFile, joined, unreadable
from fedic.io.mesh_formats.hdf._arrays import MAX_NUMBERS
from fedic.io.mesh_parts import SOLIDS, faces_of

__all__ = ["read_exodus"]

_FAMILIES = {
    "TRI": "triangle",
    "QUA": "quad",
    "SHE": "shell",
    "TET": "tetra",
    "PYR": "pyramid",
    "WED": "wedge",
    "HEX": "hexahedron",
    "BAR": "line",
    "BEA": "line",
    "TRU": "line",
    "EDG": "line",
    "CIR": "vertex",
    "SPH": "vertex",
}
"""Families of elements by the first letters of their types."""

_NAMES = {
    "triangle": {3: "triangle", 6: "triangle6", 7: "triangle7"},
    "quad": {4: "quad", 8: "quad8", 9: "quad9"},
    "shell": {3: "triangle", 4: "quad", 6: "triangle6", 7: "triangle7", 8: "quad8", 9: "quad9"},
    "tetra": {4: "tetra", 10: "tetra10"},
    "pyramid": {5: "pyramid", 13: "pyramid13"},
    "wedge": {6: "wedge", 15: "wedge15"},
    "hexahedron": {8: "hexahedron", 20: "hexahedron20", 27: "hexahedron27"},
    "line": {2: "line", 3: "line3"},
    "vertex": {1: "vertex"},
}
_ORDERS = {
    "hexahedron20": [*range(12), *range(16, 20), *range(12, 16)],
    "hexahedron27": [*range(12), *range(16, 20), *range(12, 16), 23, 24, 25, 26, 21, 22, 20],
    "wedge15": [*range(9), *range(12, 15), *range(9, 12)],
}
_SIDES = {"hexahedron": (2, 3, 4, 5, 0, 1), "tetra": (1, 2, 3, 0), "wedge": (2, 3, 4, 0, 1), "pyramid": (1, 2, 3, 4, 0)}
"""Place in `faces_of` of each side of a solid."""


def read_exodus(path: Path) -> MeshFile:
    """Read an Exodus file.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file. The sets are the node sets and, if they have names, the blocks. Side sets of
        solids are surfaces. What has no name can be chosen as ``block 1``, ``nodeset 1`` or ``sideset 1``.

    Raises
    ------
    MeshError
        If netCDF4 is missing, or the file is damaged.
    """
    try:
        import netCDF4
    except ImportError as error:
        raise MeshError(
            f"{path}: the mesh file needs netCDF4, which is not installed: pip install 'fedic[exodus]'."
        ) from error
    try:
        with netCDF4.Dataset(str(path)) as file:
            file.set_auto_mask(False)
            return _read(file)
    except ValueError as error:
        raise unreadable(path, str(error)) from error
    except (OSError, KeyError, IndexError, AttributeError, TypeError, RuntimeError, OverflowError) as error:
        lost = f": the array {error} is missing" if isinstance(error, KeyError) else ""
        raise unreadable(path, f"the file is damaged, or is no Exodus file{lost}") from error


def _read(file: Any) -> MeshFile:
    if "num_nodes" not in file.dimensions:
        raise ValueError("it is no Exodus file: the number of nodes is missing")
    if "coord" in file.variables:
        points = _numbers(file, "coord").T
    else:
        axes = [name for name in ("coordx", "coordy", "coordz") if name in file.variables]
        points = np.column_stack([_numbers(file, name) for name in axes]) if axes else np.empty((0, 0))
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise ValueError("its nodes do not have two or three coordinates")
    contents = MeshFile(points.astype(np.float64), [])
    numbered = sorted(int(name[7:]) for name in file.variables if re.fullmatch(r"connect\d+", name))
    labels = _labels(file, "eb", "block")
    contents.blocks = [_block(file, f"connect{number}") for number in numbered]
    contents.node_labels = _map(file, "node_num_map", len(points))
    sizes = np.cumsum([len(nodes) for _, nodes in contents.blocks])
    of_cells = _map(file, "elem_num_map", int(sizes[-1]) if len(sizes) else 0)
    contents.cell_labels = None if of_cells is None else np.split(of_cells, sizes[:-1])
    for index, number in enumerate(numbered):
        label, is_name = labels.get(number, (f"block {number}", False))
        members = [np.arange(len(nodes) if place == index else 0) for place, (_, nodes) in enumerate(contents.blocks)]
        (contents.cell_sets if is_name else contents.parts)[label] = members
    for number, (label, _) in _labels(file, "ns", "nodeset").items():
        if f"node_ns{number}" in file.variables:
            contents.node_sets[label] = _numbers(file, f"node_ns{number}").astype(np.int64) - 1
    for number, (label, _) in _labels(file, "ss", "sideset").items():
        if f"elem_ss{number}" in file.variables:
            _add_side_set(contents, label, *(_numbers(file, f"{part}_ss{number}") for part in ("elem", "side")))
    return contents


def _numbers(file: Any, name: str) -> Any:
    variable = file.variables[name]
    if variable.size > MAX_NUMBERS:
        raise ValueError(f"{name!r} has {variable.size} numbers, more than the {MAX_NUMBERS} that are read")
    return np.asarray(variable[:])


def _map(file: Any, name: str, count: int) -> Indices | None:
    """Return the numbers of the nodes or elements, if the file has them."""
    if name not in file.variables:
        return None
    labels: Indices = _numbers(file, name).astype(np.int64).ravel()
    return labels if len(labels) == count else None


def _labels(file: Any, kind: str, what: str) -> dict[int, tuple[str, bool]]:
    """Return for each block or set, from 1, its label, and whether that is a name."""
    dimension = {"eb": "num_el_blk", "ns": "num_node_sets", "ss": "num_side_sets"}[kind]
    count = len(file.dimensions[dimension]) if dimension in file.dimensions else 0
    names = (
        [bytes(row).partition(b"\0")[0] for row in _numbers(file, f"{kind}_names")]
        if (f"{kind}_names" in file.variables)
        else []
    )
    numbers = _numbers(file, f"{kind}_prop1").tolist() if f"{kind}_prop1" in file.variables else []
    labels = {}
    for index in range(count):
        name = names[index].decode("utf-8", "replace").strip() if index < len(names) else ""
        number = numbers[index] if index < len(numbers) else index + 1
        labels[index + 1] = (name or f"{what} {number}", bool(name))
    return labels


def _block(file: Any, variable: str) -> tuple[str, Indices]:
    kind = str(file.variables[variable].elem_type)
    nodes = np.atleast_2d(_numbers(file, variable).astype(np.int64)) - 1
    family = _FAMILIES.get(kind[:3].upper(), "")
    name = _NAMES.get(family, {}).get(nodes.shape[1], "")
    if not name:
        # A name of the family, so that surface cells of unknown order are refused and others are not measured on.
        family = "quad" if family == "shell" else family
        name = f"{family or kind} of {nodes.shape[1]} nodes"
    if name == "triangle7":
        name, nodes = "triangle6", nodes[:, :6]
    return name, nodes[:, _ORDERS[name]] if name in _ORDERS else nodes


def _add_side_set(contents: MeshFile, label: str, elements: Indices, sides: Indices) -> None:
    """Add a side set: faces of solids, the two sides of shells, or edges."""
    if len(elements) != len(sides):
        raise ValueError(f"the side set {label!r} has {len(elements)} elements and {len(sides)} sides")
    faces, rows, nodes_of_edges = [], [], []
    start = 1
    for name, nodes in contents.blocks:
        here = (elements >= start) & (elements < start + len(nodes))
        cells, of_cells = nodes[elements[here] - start], sides[here]
        shell_sides = 2 if name in CELL_TYPES and contents.points.shape[1] == 3 else 0
        rows.append(np.empty(0, dtype=np.int64))
        if name in SOLIDS:
            family = name.rstrip("0123456789")
            for side, face in enumerate(_SIDES[family], start=1):
                cell, local = faces_of(name)[face]
                faces.append((cell, cells[of_cells == side][:, local]))
        elif name in CELL_TYPES:
            rows[-1] = np.unique((elements[here] - start)[of_cells <= shell_sides])
            corners = CELL_TYPES[name].num_corners
            edges = of_cells[of_cells > shell_sides] - shell_sides - 1
            ends = cells[of_cells > shell_sides]
            for shift in (0, 1):
                nodes_of_edges.append(ends[np.arange(len(ends)), (edges + shift) % corners])
        start += len(nodes)
    blocks = [(cell, nodes) for cell, nodes in joined(faces).items() if len(nodes)]
    if blocks:
        contents.surfaces[label] = blocks
    if any(map(len, rows)):
        contents.cell_sets[label] = rows
    nodes = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *nodes_of_edges]))
    if len(nodes) and label not in contents.node_sets:
        contents.node_sets[label] = nodes
