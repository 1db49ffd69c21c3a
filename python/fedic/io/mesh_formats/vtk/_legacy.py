"""Reader of VTK's legacy format, versions 1 to 5.1, text and binary.

meshio's reader refuses files with poly-lines, polygons, strips of triangles, and arrays of text.
"""

from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from fedic.io._mesh_file import Indices, MeshFile, unreadable
from fedic.io.mesh_formats._set_fields import SET_PREFIX
from fedic.io.mesh_formats.vtk._cells import Piece, as_mesh_file
from fedic.io.mesh_formats.vtk._tokens import Tokens

__all__ = ["read_legacy_vtk"]

_POLYGONS = {"VERTICES": 2, "LINES": 4, "POLYGONS": 7, "TRIANGLE_STRIPS": 6}
_COMPONENTS = {
    "VECTORS": 3,
    "NORMALS": 3,
    "TENSORS": 9,
    "TENSORS6": 6,
    "GLOBAL_IDS": 1,
    "PEDIGREE_IDS": 1,
    "EDGE_FLAGS": 1,
}
_METADATA = {"METADATA", "INFORMATION"}
"""First words of lines after an array that describe it, up to an empty line; an array may have both."""


def read_legacy_vtk(path: Path) -> MeshFile:
    """Read a ``.vtk`` file with an unstructured grid or polygons.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file. The sets are the fields ``set:NAME``.

    Raises
    ------
    MeshError
        If the file is damaged, or holds another kind of data set.
    """
    try:
        return as_mesh_file([_Reader(path.read_bytes()).read()])
    except (ValueError, OverflowError, OSError) as error:
        raise unreadable(path, str(error)) from error


class _Reader:
    """Reader of one file, keyword by keyword."""

    def __init__(self, content: bytes) -> None:
        self._tokens = Tokens(content)
        header = self._tokens.raw_line()
        if not header.startswith("# vtk DataFile Version"):
            raise ValueError("it is no legacy file of VTK: the first line is not '# vtk DataFile Version ...'")
        try:
            self._version = float(header.split()[-1])
        except ValueError as error:
            raise ValueError(f"its version {header.split()[-1]!r} is not a number") from error
        self._tokens.raw_line()
        form = self._tokens.raw_line().strip().upper()
        if form not in ("ASCII", "BINARY"):
            raise ValueError(f"the third line is {form!r}, not ASCII or BINARY")
        self._tokens.binary = form == "BINARY"
        self._points = np.empty((0, 3))
        self._types: Indices = np.empty(0, dtype=np.int64)
        self._cells: list[tuple[int | None, Indices, Indices]] = []
        self._sets: dict[str, dict[str, NDArray[np.float64]]] = {"POINT_DATA": {}, "CELL_DATA": {}, "": {}}
        self._where = ""
        self._count = 0

    def read(self) -> Piece:
        while line := self._tokens.line():
            keyword, *words = line.split()
            try:
                self._read_section(keyword.upper(), words, line)
            except IndexError as error:
                raise ValueError(f"the line {line!r} is incomplete") from error
        ends, nodes, types, place = [], [], [], 0
        for code in dict.fromkeys([None, *_POLYGONS.values()]):
            for each, last, connectivity in self._cells:
                if each == code:
                    ends.append(last + place)
                    nodes.append(connectivity)
                    types.append(self._types if code is None else np.full(len(last), code))
                    place += len(connectivity)
        empty = [np.empty(0, dtype=np.int64)]
        return Piece(
            self._points,
            np.concatenate(empty + types),
            np.concatenate(empty + ends),
            np.concatenate(empty + nodes),
            self._sets["POINT_DATA"],
            self._sets["CELL_DATA"],
        )

    def _read_section(self, keyword: str, words: list[str], line: str) -> None:
        tokens = self._tokens
        if keyword == "DATASET":
            if words[0].upper() not in ("UNSTRUCTURED_GRID", "POLYDATA"):
                raise ValueError(f"it is a data set of type {words[0]}; save an unstructured grid or polygons")
        elif keyword == "POINTS":
            self._points = tokens.numbers(3 * _integer(words[0]), words[1]).astype(np.float64).reshape(-1, 3)
        elif keyword == "CELLS" or keyword in _POLYGONS:
            self._cells.append((_POLYGONS.get(keyword), *self._connectivity(_integer(words[0]), _integer(words[1]))))
        elif keyword == "CELL_TYPES":
            self._types = tokens.numbers(_integer(words[0]), "int").astype(np.int64)
        elif keyword in ("POINT_DATA", "CELL_DATA"):
            self._where, self._count = keyword, _integer(words[0])
        elif keyword in _METADATA:
            tokens.skip_to_empty_line()
        elif keyword == "FIELD":
            for _ in range(_integer(words[1])):
                self._read_field(tokens.line())
        elif keyword == "SCALARS":
            table = tokens.line().split()
            if table[0].upper() != "LOOKUP_TABLE":
                raise ValueError(f"the line {line!r} is not followed by LOOKUP_TABLE")
            components = _integer(words[2]) if len(words) > 2 else 1
            self._keep(words[0], tokens.numbers(self._count * components, words[1]))
        elif keyword == "COLOR_SCALARS":
            tokens.numbers(self._count * _integer(words[1]), "unsigned_char")
        elif keyword == "LOOKUP_TABLE":
            tokens.numbers(4 * _integer(words[1]), "unsigned_char")
        elif keyword == "TEXTURE_COORDINATES":
            tokens.numbers(self._count * _integer(words[1]), words[2])
        elif keyword in _COMPONENTS:
            tokens.numbers(self._count * _COMPONENTS[keyword], words[1])
        else:
            raise ValueError(f"the line {line[:60]!r} is not understood")

    def _connectivity(self, count: int, size: int) -> tuple[Indices, Indices]:
        """Return the places after the last node of each cell, and the nodes."""
        tokens = self._tokens
        if self._version >= 5.0:
            ends = self._named(count, "OFFSETS")
            nodes = self._named(size, "CONNECTIVITY")
            return ends[1:], nodes
        numbers = tokens.numbers(size, "int").astype(np.int64)
        items = numbers.tolist()
        sizes = []
        place = 0
        for _ in range(count):
            if place >= size or items[place] < 0:
                raise ValueError("the cells have more nodes than their list holds; the file is damaged")
            sizes.append(items[place])
            place += items[place] + 1
        ends = np.cumsum(np.array(sizes, dtype=np.int64))
        starts = np.concatenate([np.zeros(1, dtype=np.int64), ends[:-1]])[: len(sizes)] + np.arange(len(sizes))
        return ends, np.delete(numbers, starts)

    def _named(self, count: int, keyword: str) -> Indices:
        words = self._tokens.line().split()
        if len(words) != 2 or words[0].upper() != keyword:
            raise ValueError(f"{keyword} of the cells is missing")
        numbers: NDArray[Any] = self._tokens.numbers(count, words[1])
        if numbers.dtype.kind == "f":
            raise ValueError(f"{keyword} of the cells are not integers")
        return numbers.astype(np.int64)

    def _read_field(self, line: str) -> None:
        words = line.split()
        while words and words[0].upper() in _METADATA:
            self._tokens.skip_to_empty_line()
            words = self._tokens.line().split()
        if len(words) != 4:
            raise ValueError(f"the line {' '.join(words)[:60]!r} does not describe an array")
        name, components, count, kind = words
        size = _integer(components) * _integer(count)
        if kind.lower() == "string":
            self._tokens.skip_strings(size)
        else:
            self._keep(name, self._tokens.numbers(size, kind))

    def _keep(self, name: str, values: NDArray[Any]) -> None:
        name = unquote(name)
        if name.startswith(SET_PREFIX):
            self._sets[self._where][name.removeprefix(SET_PREFIX)] = values.astype(np.float64)


def _integer(text: str) -> int:
    if not text.isdigit():
        raise ValueError(f"{text[:60]!r} stands where a number is expected")
    return int(text)
