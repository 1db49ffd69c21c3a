"""Surface meshes in Abaqus input files.

meshio's reader supports few element types, and keeps only the last ``*NODE`` block of a file, which in most files
written by Abaqus/CAE is the reference point of the assembly.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES
from fedic.errors import MeshError
from fedic.io._abaqus_sets import SetBlock, merge_sets
from fedic.io._mesh_file import MeshFile

__all__ = ["read_abaqus"]

_CELL_NAMES = {suffix: name for name, cell in CELL_TYPES.items() for suffix in cell.abaqus_suffixes}
_SUFFIXES = "|".join(sorted(_CELL_NAMES, key=len, reverse=True))
_SURFACE_TYPE = re.compile(rf"(?:CPS|CPE|CPEG|CAX|CGAX|M3D|SFM3D|R3D|S|STRI|DS|DC2D|DCAX)({_SUFFIXES})(?!\d)")
_SCOPE_KEYWORDS = {"PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE"}
_SET_KEYWORDS = {"NSET": "node", "ELSET": "element"}


@dataclass
class _Scope:
    """The nodes, elements and sets of one part; labels are local to it."""

    name: str = ""
    part: str = ""
    labels: list[int] = field(default_factory=list)
    coordinates: list[list[float]] = field(default_factory=list)
    blocks: list[tuple[str, list[int]]] = field(default_factory=list)
    sets: list[SetBlock] = field(default_factory=list)

    def add_node(self, line: str) -> None:
        label, *coordinates = (item for item in line.split(",") if item.strip())
        self.labels.append(int(label))
        self.coordinates.append(([float(x) for x in coordinates] + [0.0, 0.0, 0.0])[:3])

    def add_element(self, line: str) -> None:
        if self.blocks[-1][0] in CELL_TYPES:
            self.blocks[-1][1].extend(int(item) for item in line.split(",") if item.strip())

    def has_surface(self) -> bool:
        return any(name in CELL_TYPES for name, _ in self.blocks)


def read_abaqus(path: Path) -> MeshFile:
    """Read the nodes, surface elements (plane, axisymmetric, shell, membrane, rigid) and sets of an input file.

    ``*INCLUDE`` is followed. The position of a part in its assembly is not applied.

    Parameters
    ----------
    path : Path
        The ``.inp`` file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file. Elements that are not surface elements come under their Abaqus name, without
        nodes.

    Raises
    ------
    MeshError
        If a line cannot be understood, an element refers to a node that does not exist, a set to a set that does not
        exist, or several parts have surface elements.
    """
    scopes = _read_scopes(path)
    with_surface = [scope for scope in scopes if scope.has_surface()]
    if len(with_surface) > 1:
        raise MeshError(f"{path}: {len(with_surface)} parts have surface elements; export a single part.")
    if not with_surface:
        names = [name for scope in scopes for name, _ in scope.blocks]
        return MeshFile(np.empty((0, 3)), [(name, np.empty((0, 0), dtype=np.int64)) for name in names])
    (scope,) = with_surface
    labels = np.asarray(scope.labels, dtype=np.int64)
    tables = [_element_table(path, name, items) for name, items in scope.blocks]
    blocks = [(name, _connectivity(path, table, labels)) for (name, _), table in zip(scope.blocks, tables, strict=True)]
    node_sets, cell_sets = merge_sets(path, _sets_of(scope, scopes), labels, [table[:, 0] for table in tables], blocks)
    points = np.asarray(scope.coordinates, dtype=np.float64).reshape(-1, 3)
    return MeshFile(points, blocks, node_sets, cell_sets)


def _sets_of(scope: _Scope, scopes: list[_Scope]) -> list[SetBlock]:
    """Return the sets of a part, and those that the assembly defines on an instance of it.

    A set of the assembly whose name the part uses as well is renamed ``Assembly.NAME``.
    """
    instances = {each.name for each in scopes if each is scope or each.part == scope.name} - {""}
    used = {(block.kind, block.name.upper()) for block in scope.sets}
    of_assembly = [
        replace(block, name=f"Assembly.{block.name}") if (block.kind, block.name.upper()) in used else block
        for each in scopes
        if each is not scope
        for block in each.sets
        if block.instance in instances
    ]
    return scope.sets + of_assembly


def _read_scopes(path: Path) -> list[_Scope]:
    scopes = [_Scope()]
    keyword = ""
    for source, number, line in _lines(path):
        try:
            if line.startswith("*"):
                keyword, options = _split_keyword(line)
                _start_block(scopes, keyword, options)
            elif keyword == "NODE":
                scopes[-1].add_node(line)
                if scopes[-1].sets[-1].name:
                    scopes[-1].sets[-1].lines.append([line.split(",")[0].strip()])
            elif keyword == "ELEMENT":
                scopes[-1].add_element(line)
            elif keyword in _SET_KEYWORDS:
                scopes[-1].sets[-1].lines.append([item.strip() for item in line.split(",") if item.strip()])
        except ValueError as error:
            raise MeshError(f"{source}, line {number}: not a valid line of *{keyword} ({error}).") from error
    return scopes


def _start_block(scopes: list[_Scope], keyword: str, options: dict[str, str]) -> None:
    if keyword in _SCOPE_KEYWORDS:
        scopes.append(_Scope(options.get("NAME", "").upper(), options.get("PART", "").upper()))
    scope = scopes[-1]
    if keyword == "NODE":
        scope.sets.append(SetBlock("node", options.get("NSET", "")))
    elif keyword == "ELEMENT":
        scope.blocks.append((_cell_name(options.get("TYPE", "")), []))
        if "ELSET" in options:
            scope.sets.append(SetBlock("element", options["ELSET"], block=len(scope.blocks) - 1))
    elif keyword in _SET_KEYWORDS:
        scope.sets.append(
            SetBlock(
                _SET_KEYWORDS[keyword],
                options.get(keyword, ""),
                instance=options.get("INSTANCE", "").upper(),
                generate="GENERATE" in options,
                of_elements=options.get("ELSET", "") if keyword == "NSET" else "",
            )
        )


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


def _element_table(path: Path, name: str, items: list[int]) -> NDArray[np.int64]:
    """Return the label and the node labels of each element of a block, one per row."""
    if name not in CELL_TYPES:
        return np.empty((0, 1), dtype=np.int64)
    width = CELL_TYPES[name].num_nodes + 1
    if len(items) % width:
        raise MeshError(
            f"{path}: an element of the {name} blocks does not have {width - 1} nodes; the file is damaged."
        )
    return np.asarray(items, dtype=np.int64).reshape(-1, width)


def _connectivity(path: Path, table: NDArray[np.int64], labels: NDArray[np.int64]) -> NDArray[np.int64]:
    order = np.argsort(labels, kind="stable")
    place = np.minimum(np.searchsorted(labels, table[:, 1:], sorter=order), max(len(labels) - 1, 0))
    nodes = order[place] if len(labels) else place
    unknown = (labels[nodes] != table[:, 1:]) if len(labels) else np.ones_like(nodes, dtype=bool)
    if unknown.any():
        row, column = np.argwhere(unknown)[0]
        raise MeshError(
            f"{path}: element {table[row, 0]} refers to node {table[row, 1 + column]}, which the file does not define."
        )
    return nodes
