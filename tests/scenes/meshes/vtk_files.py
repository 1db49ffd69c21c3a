"""Files of VTK, written number by number, as VTK 9 writes them."""

import base64
import lzma
import zlib
from pathlib import Path
from typing import Any

import imagecodecs
import numpy as np

from scenes.meshes.plate import LEFT, MIXED_QUADS, POINTS, QUADS, TRIANGLES

__all__ = [
    "CELLS",
    "write_cells",
    "write_image",
    "write_legacy",
    "write_legacy_image",
    "write_legacy_polygons",
    "write_pieces",
    "write_vtp",
    "write_vtu",
    "write_with_text",
]

_COMPRESS = {
    "ZLib": zlib.compress,
    "LZMA": lzma.compress,
    "LZ4": imagecodecs.lz4_encode,
}
_NAMES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8", "i4": "Int32"}
_IS_LEFT = np.isin(np.arange(len(POINTS)), LEFT).astype("i4")

Cells = list[tuple[int, list[int]]]
_MIDDLES = [(1.5, 0.0), (3.0, 1.0), (1.5, 2.0), (0.0, 1.0), (1.5, 1.0)]
_CORNERS = [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)]
NINE_POINTS = np.array([(x, y, 0.0) for x, y in _CORNERS + _MIDDLES] + [(1.0, 2 / 3, 0.0), (2.0, 4 / 3, 0.0)])
CELLS: dict[str, tuple[Cells, dict[str, int]]] = {
    "pixels": ([(8, [0, 1, 3, 2])], {"quad": 1}),
    "polygons of 3 and 4 nodes": ([(7, [0, 1, 8, 3]), (7, [1, 2, 8]), (7, [2, 3, 8])], {"quad": 1, "triangle": 2}),
    "a strip of triangles": ([(6, [0, 1, 3, 2])], {"triangle": 2}),
    "Lagrange triangles of order 1": ([(69, [0, 1, 2]), (69, [0, 2, 3])], {"triangle": 2}),
    "Lagrange triangles of order 2": (
        [(69, [0, 1, 2, 4, 5, 8]), (69, [0, 2, 3, 8, 6, 7])],
        {"triangle6": 2},
    ),
    "Lagrange quadrilaterals of order 1": ([(70, [0, 1, 2, 3])], {"quad": 1}),
    "Lagrange quadrilaterals of order 2": ([(70, [0, 1, 2, 3, 4, 5, 6, 7, 8])], {"quad9": 1}),
    "triangles of 7 nodes": ([(34, [0, 1, 2, 4, 5, 8, 10]), (34, [0, 2, 3, 8, 6, 7, 9])], {"triangle6": 2}),
    "points, lines, poly-lines beside a quadrilateral": (
        [(1, [0]), (3, [0, 1]), (4, [0, 1, 2]), (2, [0, 1]), (9, [0, 1, 2, 3])],
        {"quad": 1},
    ),
    "a polygon of 5 nodes": ([(7, [0, 4, 1, 2, 3])], {}),
    "Lagrange quadrilaterals of order 1 x 3": ([(70, [0, 1, 2, 3, 4, 5, 6, 7])], {}),
}
"""Cells of one plate, by VTK's type and nodes, and what is read."""


class _Arrays:
    """Writer of arrays in one form."""

    def __init__(self, form: str, compressor: str, order: str, header: str) -> None:
        self.form, self.compressor, self.order = form, compressor, order
        self.header = np.dtype(order + ("u4" if header == "UInt32" else "u8"))
        self.appended = b""

    def array(self, name: str, values: Any, components: int = 1) -> str:
        values = np.ascontiguousarray(values)
        kind = _NAMES[values.dtype.str[1:]]
        start = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format='
        if self.form == "ascii":
            return f'{start}"ascii">{" ".join(map(repr, values.ravel().tolist()))}</DataArray>\n'
        data = values.astype(values.dtype.newbyteorder(self.order)).tobytes()
        head, body = self._packed(data)
        coded = base64.b64encode(head) + base64.b64encode(body) if self.compressor else base64.b64encode(head + body)
        if self.form == "binary":
            return f'{start}"binary">\n{coded.decode()}\n</DataArray>\n'
        offset = len(self.appended)
        self.appended += coded if self.form == "appended base64" else head + body
        return f'{start}"appended" offset="{offset}"/>\n'

    def _packed(self, data: bytes) -> tuple[bytes, bytes]:
        if not self.compressor:
            return np.array([len(data)], self.header).tobytes(), data
        size = 100
        blocks = [data[start : start + size] for start in range(0, len(data), size)]
        packed = [bytes(_COMPRESS[self.compressor](block)) for block in blocks]
        last = len(blocks[-1]) if len(blocks[-1]) < size else 0
        sizes = [len(blocks), size, last, *map(len, packed)]
        return np.array(sizes, self.header).tobytes(), b"".join(packed)


def _write(path: Path, kind: str, pieces: str, arrays: _Arrays) -> None:
    compressor = f' compressor="vtk{arrays.compressor}DataCompressor"' if arrays.compressor else ""
    order = "BigEndian" if arrays.order == ">" else "LittleEndian"
    header = "UInt32" if arrays.header.itemsize == 4 else "UInt64"
    text = (
        f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="{order}" header_type="{header}"'
        f"{compressor}>\n<{kind}>\n{pieces}</{kind}>\n"
    ).encode()
    if arrays.appended:
        encoding = arrays.form.removeprefix("appended ")
        text += f'<AppendedData encoding="{encoding}">\n_'.encode() + arrays.appended + b"\n</AppendedData>\n"
    path.write_bytes(text + b"</VTKFile>\n")


def _piece(arrays: _Arrays, points: Any, cells: Cells, point_data: str = "") -> str:
    nodes = [node for _, each in cells for node in each]
    ends = np.cumsum([len(each) for _, each in cells])
    types = np.array([code for code, _ in cells], dtype="u1")
    return (
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">\n<PointData>{point_data}</PointData>\n'
        f"<Points>{arrays.array('Points', points, 3)}</Points>\n"
        f"<Cells>{arrays.array('connectivity', np.array(nodes))}{arrays.array('offsets', ends)}"
        f"{arrays.array('types', types)}</Cells>\n</Piece>\n"
    )


def _quads() -> Cells:
    return [(9, nodes) for nodes in QUADS.tolist()]


def write_vtu(path: Path, form: str, compressor: str = "", order: str = "<", header: str = "UInt32") -> None:
    arrays = _Arrays(form, compressor, order, header)
    piece = _piece(arrays, POINTS, _quads(), arrays.array("set:left", _IS_LEFT))
    _write(path, "UnstructuredGrid", piece, arrays)


def write_cells(path: Path, cells: Cells) -> None:
    arrays = _Arrays("ascii", "", "<", "UInt32")
    used = np.unique(np.concatenate([nodes for _, nodes in cells]))
    new = {int(node): index for index, node in enumerate(used)}
    renumbered = [(code, [new[node] for node in nodes]) for code, nodes in cells]
    _write(path, "UnstructuredGrid", _piece(arrays, NINE_POINTS[used], renumbered), arrays)


def write_with_text(path: Path) -> None:
    arrays = _Arrays("ascii", "", "<", "UInt32")
    text = '<DataArray type="String" Name="names" format="ascii">104 105 0 104 105 0</DataArray>'
    _write(path, "UnstructuredGrid", _piece(arrays, POINTS, _quads(), text), arrays)


def write_pieces(path: Path) -> None:
    arrays = _Arrays("binary", "", "<", "UInt32")
    pieces = _piece(arrays, POINTS, _quads()[:3]) + _piece(arrays, POINTS, _quads()[3:])
    _write(path, "UnstructuredGrid", pieces, arrays)


def write_vtp(path: Path) -> None:
    arrays = _Arrays("binary", "ZLib", "<", "UInt32")
    sections = {
        "Verts": [[0]],
        "Lines": [[0, 1, 2, 3]],
        "Strips": [[1, 2, 5, 6], [2, 3, 6, 7]],
        "Polys": [
            [0, 1, 5, 4],
            [4, 5, 9, 8],
            *([t for a, b, c, d in QUADS[4:].tolist() for t in ([a, b, c], [a, c, d])]),
        ],
    }
    counts = " ".join(f'NumberOf{name}="{len(cells)}"' for name, cells in sections.items())
    text = f'<Piece NumberOfPoints="{len(POINTS)}" {counts}>\n<Points>{arrays.array("Points", POINTS, 3)}</Points>\n'
    for name, cells in sections.items():
        nodes, ends = np.concatenate(cells), np.cumsum([len(each) for each in cells])
        text += f"<{name}>{arrays.array('connectivity', nodes)}{arrays.array('offsets', ends)}</{name}>\n"
    _write(path, "PolyData", text + "</Piece>\n", arrays)


def write_image(path: Path) -> None:
    path.write_text('<VTKFile type="ImageData" version="1.0"><ImageData WholeExtent="0 3 0 2 0 0"/></VTKFile>')


def _legacy(path: Path, version: float, binary: bool, *parts: Any) -> None:
    """Write parts of text, and arrays in the form of the file."""
    form = "BINARY" if binary else "ASCII"
    content = f"# vtk DataFile Version {version}\n\n{form}\n".encode()
    for part in parts:
        if isinstance(part, str):
            content += part.encode()
        elif isinstance(part, bytes):
            content += part
        elif binary:
            content += part.astype(part.dtype.newbyteorder(">")).tobytes() + b"\n"
        else:
            content += (" ".join(map(repr, part.ravel().tolist())) + "\n").encode()
    path.write_bytes(content)


def _legacy_cells(keyword: str, cells: list[list[int]], version: float) -> list[Any]:
    if version >= 5.0:
        ends = np.cumsum([0, *map(len, cells)])
        nodes = np.concatenate(cells)
        start = f"{keyword} {len(ends)} {len(nodes)}\nOFFSETS vtktypeint64\n"
        return [start, ends, "CONNECTIVITY vtktypeint64\n", nodes, "\n"]
    counted = np.concatenate([[len(nodes), *nodes] for nodes in cells]).astype("i4")
    return [f"{keyword} {len(cells)} {len(counted)}\n", counted, "\n"]


def write_legacy(path: Path, version: float, binary: bool) -> None:
    cells = [*QUADS.tolist(), [0, 1, 2]]
    types = np.array([9] * len(QUADS) + [4], dtype="i4")
    texts = b"\xc2hi\xc0\xc2ho" * 4 if binary else b"hi\n\nho\n" * 4
    _legacy(
        path,
        version,
        binary,
        f"DATASET UNSTRUCTURED_GRID\nPOINTS {len(POINTS)} double\n",
        POINTS,
        "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 3.6\n\n",
        *_legacy_cells("CELLS", cells, version),
        f"CELL_TYPES {len(types)}\n",
        types,
        "METADATA\nCOMPONENT_NAMES\nx%20y\n\n\n",
        "INFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 3.6\n\n",
        f"CELL_DATA {len(cells)}\nSCALARS id int 1\nLOOKUP_TABLE default\n",
        types,
        f"POINT_DATA {len(POINTS)}\nVECTORS U double\n",
        POINTS,
        f"FIELD FieldData 2\nnames 1 {len(POINTS)} string\n",
        texts,
        f"\nset:left 1 {len(POINTS)} int\n",
        _IS_LEFT,
    )


def write_legacy_polygons(path: Path, version: float, binary: bool) -> None:
    _legacy(
        path,
        version,
        binary,
        f"DATASET POLYDATA\nPOINTS {len(POINTS)} float\n",
        POINTS.astype("f4"),
        *_legacy_cells("LINES", [[0, 1, 2, 3]], version),
        *_legacy_cells("POLYGONS", MIXED_QUADS.tolist() + TRIANGLES[:2].tolist(), version),
        *_legacy_cells("TRIANGLE_STRIPS", [[6, 7, 10, 11]], version),
    )


def write_legacy_image(path: Path) -> None:
    path.write_text("# vtk DataFile Version 3.0\nimage\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 1\n")
