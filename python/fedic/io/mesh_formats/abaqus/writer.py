"""Writing of Abaqus input files."""

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES
from fedic.errors import MeshError

__all__ = ["write_abaqus"]

_PLANE, _SPATIAL = "CPS", "M3D"
_PLANE_CELLS = ("triangle", "triangle6", "quad", "quad8")
_PLAIN_NAME = re.compile(r"[A-Za-z]\w*", re.ASCII)
_LONGEST_NAME = 80
_COLUMNS = 20
"""Largest width of a number."""
_PER_LINE = 16


def write_abaqus(
    path: Path,
    points: NDArray[np.float64],
    cells: Mapping[str, NDArray[np.int64]],
    node_sets: Mapping[str, NDArray[np.int64]],
    cell_sets: Mapping[str, NDArray[np.int64]],
    *,
    node_labels: NDArray[np.int64] | None = None,
    cell_labels: NDArray[np.int64] | None = None,
) -> None:
    """Write a mesh as an input file without parts.

    The elements of a mesh in the plane z = 0 are those of plane stress: ``CPS3``, ``CPS4``, ``CPS6`` and ``CPS8``.
    Those of any other mesh, and of one with cells of nine nodes, are membranes: ``M3D3`` to ``M3D9``.

    Parameters
    ----------
    path : Path
        The file.
    points : ndarray, shape (n, 3)
        Nodes.
    cells : dict of str to ndarray of int, shape (m, k)
        Cells by type.
    node_sets, cell_sets : dict of str to ndarray of int
        Nodes and cells of the named sets, cells counted over all types.
    node_labels, cell_labels : ndarray of int, optional
        Numbers of the nodes and elements; from 1, in their order, by default.

    Raises
    ------
    MeshError
        If Abaqus does not allow the name of a set.
    """
    if node_labels is None:
        node_labels = np.arange(1, len(points) + 1)
    if cell_labels is None:
        cell_labels = np.arange(1, sum(map(len, cells.values())) + 1)
    plane = not points[:, 2].any() and all(cell in _PLANE_CELLS for cell in cells)
    with path.open("w", encoding="utf-8") as file:
        file.write("*HEADING\nmesh written by fedic\n*NODE\n")
        file.writelines(
            f"{label}, {', '.join(map(_number, point))}\n"
            for label, point in zip(node_labels.tolist(), points.tolist(), strict=True)
        )
        first = 0
        for cell, nodes in cells.items():
            file.write(f"*ELEMENT, TYPE={_PLANE if plane else _SPATIAL}{CELL_TYPES[cell].abaqus_suffixes[0]}\n")
            labels = cell_labels[first : first + len(nodes)]
            np.savetxt(file, np.column_stack([labels, node_labels[nodes]]), fmt="%d", delimiter=", ")
            first += len(nodes)
        for keyword, sets, labels in (("NSET", node_sets, node_labels), ("ELSET", cell_sets, cell_labels)):
            for name, members in sets.items():
                file.write(f"*{keyword}, {keyword}={_name(path, name)}\n")
                file.writelines(_rows(labels[members].tolist()))


def _number(value: float) -> str:
    """Return a coordinate to as many digits as there is room for."""
    digits = 16
    text = repr(value)
    while len(text) > _COLUMNS:
        digits -= 1
        text = f"{value:.{digits}e}"
    return text


def _name(path: Path, name: str) -> str:
    """Return the name of a set, in quotation marks where it needs them."""
    if _PLAIN_NAME.fullmatch(name) and len(name) <= _LONGEST_NAME:
        return name
    if not name.isprintable() or '"' in name or name != name.strip() or not 0 < len(name) <= _LONGEST_NAME:
        raise MeshError(
            f"{path}: the set {name[:_LONGEST_NAME]!r} cannot be written: a name in Abaqus has at most {_LONGEST_NAME} "
            "characters, no quotation marks, and no blanks at its ends; rename the set, or write '.vtu' instead."
        )
    return f'"{name}"'


def _rows(labels: list[int]) -> Iterator[str]:
    rows: Iterable[list[int]] = (labels[at : at + _PER_LINE] for at in range(0, len(labels), _PER_LINE))
    return (", ".join(map(str, row)) + "\n" for row in rows)
