"""Reader of VTK's XML formats of unstructured grids and polygons.

meshio's reader refuses files with arrays of text, LZ4, pixels, triangles of seven nodes and all polygons.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, ParseError

import numpy as np

from fedic.io._mesh_file import Indices, MeshFile, unreadable
from fedic.io.mesh_formats._set_fields import SET_PREFIX
from fedic.io.mesh_formats.vtk._arrays import ArrayReader
from fedic.io.mesh_formats.vtk._cells import Piece, as_mesh_file

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["read_xml_vtk"]

_APPENDED = re.compile(rb"<AppendedData([^>]*)>\s*_")
_END_OF_APPENDED = b"</AppendedData>"
_POLYGONS = {"Verts": 2, "Lines": 4, "Polys": 7, "Strips": 6}
"""Elements of a file of polygons, in the order of the fields of its cells, and VTK's type of their cells."""


def read_xml_vtk(path: Path) -> MeshFile:
    """Read a ``.vtu`` or ``.vtp`` file: text, base64, or raw appended arrays, compressed or not, in one or more pieces.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file, piece after piece. The sets are the fields ``set:NAME``.

    Raises
    ------
    MeshError
        If the file is damaged, or holds another kind of data set.
    """
    try:
        return _read(path.read_bytes())
    except (ValueError, ParseError, LookupError, OSError) as error:
        raise unreadable(path, str(error)) from error


def _read(content: bytes) -> MeshFile:
    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    appended = _APPENDED.search(content)
    head = content if appended is None else content[: appended.start()] + b"</VTKFile>"
    try:
        root = fromstring(head, forbid_dtd=True)
    except DefusedXmlException as error:
        raise ValueError("it declares entities of XML, which are not read") from error
    except ParseError as error:
        raise ValueError(f"it is not well-formed XML: {error}") from error
    kind = root.get("type", "")
    if root.tag != "VTKFile" or kind not in ("UnstructuredGrid", "PolyData"):
        what = f"a data set of type {kind!r}" if root.tag == "VTKFile" else f"XML of type {root.tag!r}"
        raise ValueError(f"it is {what}; save an unstructured grid or polygons")
    arrays = _array_reader(root, content, appended)
    pieces = root.findall(f"{kind}/Piece")
    read_piece = _grid if kind == "UnstructuredGrid" else _polygons
    return as_mesh_file([_with_sets(read_piece(piece, arrays), piece, arrays) for piece in pieces])


def _array_reader(root: Element, content: bytes, appended: "re.Match[bytes] | None") -> ArrayReader:
    data, raw = b"", False
    if appended is not None:
        raw = re.search(rb"encoding\s*=\s*[\"']raw[\"']", appended[1]) is not None
        end = content.rfind(_END_OF_APPENDED)
        data = content[appended.end() : end if end >= 0 else len(content)]
    offsets = sorted({int(array.get("offset", "0")) for array in root.iter("DataArray") if array.get("offset")})
    return ArrayReader(dict(root.attrib), data, raw, offsets)


def _count(piece: Element, name: str) -> int:
    text = piece.get(name, "0")
    if not text.strip().isdigit():
        raise ValueError(f"{name} is {text!r}, not a number")
    return int(text)


def _points(piece: Element, arrays: ArrayReader) -> "NDArray[np.float64]":
    count = _count(piece, "NumberOfPoints")
    if count == 0:
        return np.empty((0, 3))
    array = piece.find("Points/DataArray")
    if array is None:
        raise ValueError("a piece has no points")
    points = arrays.read(array, np.float64)
    if points.size != 3 * count:
        raise ValueError(f"a piece declares {count} points but holds {points.size} coordinates")
    return points.reshape(-1, 3)


def _cells(section: Element | None, arrays: ArrayReader, count: int, *names: str) -> Iterator[Indices]:
    """Yield arrays of the cells."""
    for name in names:
        array = None if section is None else section.find(f"DataArray[@Name='{name}']")
        if count == 0:
            yield np.empty(0, dtype=np.int64)
            continue
        if array is None:
            raise ValueError(f"a piece declares {count} cells but has no array {name!r} of them")
        values: Indices = arrays.read(array, np.int64)
        if name != "connectivity" and len(values) != count:
            raise ValueError(f"a piece declares {count} cells, but its array {name!r} has {len(values)} values")
        yield values


def _grid(piece: Element, arrays: ArrayReader) -> Piece:
    count = _count(piece, "NumberOfCells")
    connectivity, ends, types = _cells(piece.find("Cells"), arrays, count, "connectivity", "offsets", "types")
    return Piece(_points(piece, arrays), types, ends, connectivity)


def _polygons(piece: Element, arrays: ArrayReader) -> Piece:
    types, ends, nodes = [], [], []
    place = 0
    for section, code in _POLYGONS.items():
        count = _count(piece, f"NumberOf{section}")
        connectivity, last = _cells(piece.find(section), arrays, count, "connectivity", "offsets")
        types.append(np.full(count, code))
        ends.append(last + place)
        nodes.append(connectivity)
        place += len(connectivity)
    return Piece(_points(piece, arrays), np.concatenate(types), np.concatenate(ends), np.concatenate(nodes))


def _with_sets(read: Piece, piece: Element, arrays: ArrayReader) -> Piece:
    for section, sets in (("PointData", read.point_sets), ("CellData", read.cell_sets)):
        for array in piece.iterfind(f"{section}/DataArray"):
            name = array.get("Name", "")
            if name.startswith(SET_PREFIX):
                sets[name.removeprefix(SET_PREFIX)] = arrays.read(array, np.float64)
    return read
