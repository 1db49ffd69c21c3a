"""Reading the surface mesh of an Abaqus input file.

meshio's reader knows few element types, and keeps only the last ``*NODE`` block of a file, which in most files written
by Abaqus/CAE is the reference point of the assembly.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import NODE_COUNTS
from fedic.errors import MeshError

__all__ = ["read_abaqus"]

_SURFACE_TYPE = re.compile(r"(?:CPS|CPE|CPEG|CAX|CGAX|M3D|SFM3D|R3D|S|STRI|DS|DC2D|DCAX)(65|[34689])(?!\d)")
_CELL_NAMES = {"3": "triangle", "4": "quad", "6": "triangle6", "65": "triangle6", "8": "quad8", "9": "quad9"}
_SCOPE_KEYWORDS = {"PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE"}


@dataclass
class _Scope:
    """The nodes and elements of one part, whose labels mean nothing outside it."""

    labels: list[int] = field(default_factory=list)
    coordinates: list[list[float]] = field(default_factory=list)
    blocks: list[tuple[str, list[int]]] = field(default_factory=list)

    def add_node(self, line: str) -> None:
        label, *coordinates = (item for item in line.split(",") if item.strip())
        self.labels.append(int(label))
        self.coordinates.append(([float(x) for x in coordinates] + [0.0, 0.0, 0.0])[:3])

    def add_element(self, line: str) -> None:
        if self.blocks[-1][0] in NODE_COUNTS:
            self.blocks[-1][1].extend(int(item) for item in line.split(",") if item.strip())


def read_abaqus(path: Path) -> tuple[NDArray[np.float64], list[tuple[str, NDArray[np.int64]]]]:
    """Read the nodes and the surface elements (plane, axisymmetric, shell, membrane, rigid) of an input file.

    ``*INCLUDE`` is followed. The position of a part in its assembly is not applied.

    Parameters
    ----------
    path : Path
        The ``.inp`` file.

    Returns
    -------
    points : ndarray of float, shape (n, 3)
        In the order of the file.
    blocks : list of (str, ndarray of int, shape (m, k))
        Surface cells by their meshio name, their nodes counted from 0 in `points`. Elements of another kind come under
        their Abaqus name, without nodes.

    Raises
    ------
    MeshError
        If a line cannot be understood, an element names a node that does not exist, or several parts have surface
        elements.
    """
    scopes = _read_scopes(path)
    with_surface = [scope for scope in scopes if any(name in NODE_COUNTS for name, _ in scope.blocks)]
    if len(with_surface) > 1:
        raise MeshError(f"{path}: {len(with_surface)} parts have surface elements; export one part alone.")
    if not with_surface:
        kinds = [name for scope in scopes for name, _ in scope.blocks]
        return np.empty((0, 3)), [(name, np.empty((0, 0), dtype=np.int64)) for name in kinds]
    (scope,) = with_surface
    labels = np.asarray(scope.labels, dtype=np.int64)
    blocks = [(name, _connectivity(path, name, items, labels)) for name, items in scope.blocks]
    return np.asarray(scope.coordinates, dtype=np.float64).reshape(-1, 3), blocks


def _read_scopes(path: Path) -> list[_Scope]:
    scopes = [_Scope()]
    keyword = ""
    for source, number, line in _lines(path):
        try:
            if line.startswith("*"):
                keyword, options = _split_keyword(line)
                if keyword in _SCOPE_KEYWORDS:
                    scopes.append(_Scope())
                elif keyword == "ELEMENT":
                    scopes[-1].blocks.append((_cell_name(options.get("TYPE", "")), []))
            elif keyword == "NODE":
                scopes[-1].add_node(line)
            elif keyword == "ELEMENT":
                scopes[-1].add_element(line)
        except ValueError as error:
            raise MeshError(f"{source}, line {number}: not a valid line of *{keyword} ({error}).") from error
    return scopes


def _lines(path: Path, including: tuple[Path, ...] = ()) -> Iterator[tuple[Path, int, str]]:
    if path.resolve() in including:
        raise MeshError(f"{path}: the file includes itself through *INCLUDE; remove that line.")
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise MeshError(f"{path}: the mesh file cannot be read ({error.strerror}).") from error
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        keyword, options = _split_keyword(line)
        if keyword == "INCLUDE" and "INPUT" in options:
            yield from _lines(path.parent / options["INPUT"], (*including, path.resolve()))
        else:
            yield path, number, line


def _split_keyword(line: str) -> tuple[str, dict[str, str]]:
    if not line.startswith("*"):
        return "", {}
    keyword, *options = line[1:].split(",")
    pairs = (option.partition("=") for option in options)
    return " ".join(keyword.upper().split()), {key.strip().upper(): value.strip() for key, _, value in pairs}


def _cell_name(element_type: str) -> str:
    surface = _SURFACE_TYPE.match(element_type.upper())
    return _CELL_NAMES[surface.group(1)] if surface else element_type


def _connectivity(path: Path, name: str, items: list[int], labels: NDArray[np.int64]) -> NDArray[np.int64]:
    if name not in NODE_COUNTS:
        return np.empty((0, 0), dtype=np.int64)
    width = NODE_COUNTS[name] + 1
    if len(items) % width:
        raise MeshError(f"{path}: an element of the {name} blocks has not {width - 1} nodes; the file is damaged.")
    table = np.asarray(items, dtype=np.int64).reshape(-1, width)
    order = np.argsort(labels, kind="stable")
    place = np.minimum(np.searchsorted(labels, table[:, 1:], sorter=order), max(len(labels) - 1, 0))
    nodes = order[place] if len(labels) else place
    unknown = (labels[nodes] != table[:, 1:]) if len(labels) else np.ones_like(nodes, dtype=bool)
    if unknown.any():
        row, column = np.argwhere(unknown)[0]
        raise MeshError(
            f"{path}: element {table[row, 0]} names node {table[row, 1 + column]}, which the file does not define."
        )
    return nodes
