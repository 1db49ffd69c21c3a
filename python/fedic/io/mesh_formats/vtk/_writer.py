"""Surface meshes with fields in VTK's XML format, for ParaView.

The format is small; importing meshio takes 60 ms, a fifth of the time of a measurement of five megapixels.
"""

import base64
from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES

__all__ = ["write_vtu"]

_TYPE_NAMES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}

Array = NDArray[Any]


def write_vtu(
    path: Path,
    points: Array,
    cells: Mapping[str, Array],
    point_data: Mapping[str, Array],
    cell_data: Mapping[str, Array],
    field_data: Mapping[str, Array],
    units: Mapping[str, str] | None = None,
) -> None:
    """Write an unstructured grid with base64-encoded arrays.

    Parameters
    ----------
    path : Path
        The file to write.
    points : (n, 3) float64
        Nodes.
    cells : dict
        Nodes of the cells, (m, k) integers by name of the type.
    point_data, cell_data : dict
        Fields by name, float64, int64 or uint8: (n,) or (n, 3) on the nodes, (m,) on the cells, those of one type after
        the other.
    field_data : dict
        Arrays of the whole file by name, (k,).
    units : dict, optional
        Units by the names of arrays, written as VTK's key ``UNITS_LABEL``.
    """
    counts = {name: nodes.shape for name, nodes in cells.items()}
    sizes = np.concatenate([np.full(count, size) for count, size in counts.values()]).astype("<i8")
    types = np.concatenate([np.full(count, CELL_TYPES[name].vtk_type) for name, (count, _) in counts.items()]).astype(
        "u1"
    )
    connectivity = np.concatenate([nodes.ravel() for nodes in cells.values()]).astype("<i8")
    grid = [
        ("PointData", point_data.items()),
        ("CellData", cell_data.items()),
        ("Points", [("Points", points)]),
        ("Cells", [("connectivity", connectivity), ("offsets", np.cumsum(sizes)), ("types", types)]),
    ]
    with path.open("wb") as file:
        file.write(b'<?xml version="1.0"?>\n')
        file.write(b'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n')
        file.write(b"<UnstructuredGrid>\n")
        file.write(b"<FieldData>\n")
        file.writelines(_data_arrays(field_data.items(), counted=True))
        file.write(b"</FieldData>\n")
        file.write(f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(sizes)}">\n'.encode())
        for section, arrays in grid:
            file.write(f"<{section}>\n".encode())
            file.writelines(_data_arrays(arrays, units=units or {}))
            file.write(f"</{section}>\n".encode())
        file.write(b"</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


def _data_arrays(
    arrays: Iterable[tuple[str, Array]], *, counted: bool = False, units: Mapping[str, str] = MappingProxyType({})
) -> Iterable[bytes]:
    for name, values in arrays:
        numbers = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
        components = f' NumberOfComponents="{numbers.shape[1]}"' if numbers.ndim > 1 else ""
        components += f' NumberOfTuples="{len(numbers)}"' if counted else ""
        kind = _TYPE_NAMES[numbers.dtype.str[1:]]
        yield f'<DataArray type="{kind}" Name="{escape(name)}"{components} format="binary">\n'.encode()
        yield base64.b64encode(np.uint64(numbers.nbytes).astype("<u8").tobytes() + numbers.tobytes())
        if name in units:
            key = f'<InformationKey name="UNITS_LABEL" location="vtkDataArray">{escape(units[name])}</InformationKey>'
            yield f"\n{key}".encode()
        yield b"\n</DataArray>\n"
