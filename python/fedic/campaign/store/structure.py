"""Creation of the file of a campaign, with room for a number of frames.

All room is allocated when the file is made, in one piece for each field. Afterwards only the values of frames are
written, and the number of frames: a process that is killed cannot leave the structure of the file half written.
"""

import itertools
import json
from collections.abc import Iterator, Mapping
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES, Mesh, MeshSet, __version__
from fedic.campaign.store.layout import COLUMNS, FORMAT, INFORMATION, UNCHECKED, VTK_VERSION, Field, fields
from fedic.results import StrainMeasure

__all__ = ["bytes_per_frame", "create", "datasets_of_frames", "read_mask", "read_mesh", "read_text"]


def create(
    file: Any,
    mesh: Mesh,
    mask: NDArray[np.bool_] | None,
    texts: Mapping[str, str],
    measure: StrainMeasure,
    capacity: int,
    *,
    drift: bool,
) -> None:
    """Write the structure of a file without frames.

    Parameters
    ----------
    file : h5py.File
        An empty file.
    mesh : Mesh
        The mesh.
    mask : ndarray of bool, shape (height, width), or None
        Pixels of the reference image that are left out.
    texts : mapping of str to str
        Texts of the group ``fedic``.
    measure : {"green-lagrange", "hencky", "small"}
        Measure of the strains.
    capacity : int
        Number of frames to make room for.
    drift : bool
        Whether there is a field for the drift.
    """
    grid = file.create_group("VTKHDF")
    grid.attrs["Version"] = np.array(VTK_VERSION, dtype=np.int64)
    grid.attrs.create("Type", np.bytes_("UnstructuredGrid"), dtype=h5py.string_dtype("ascii", len("UnstructuredGrid")))
    _write_mesh(grid, mesh)
    steps = grid.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(0)
    one, zero = np.ones(capacity, dtype=np.int64), np.zeros(capacity, dtype=np.int64)
    steps["NumberOfParts"] = one
    for name in ("PartOffsets", "PointOffsets"):
        steps[name] = zero
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = zero[:, np.newaxis]
    _allocate(steps, "Values", (capacity,), "f8")
    for field in fields(measure, drift=drift):
        rows = field.rows(mesh)
        offsets = steps.require_group(f"{field.group}Offsets")
        offsets[field.name] = rows * np.arange(capacity, dtype=np.int64)
        _allocate(grid.require_group(field.group), field.name, _shape(field, capacity * rows), field.dtype)
    own = file.create_group("fedic")
    own.attrs["format"] = np.int64(FORMAT)
    own.attrs["version"] = np.bytes_(__version__)
    for name, text in texts.items():
        own[name] = np.bytes_(text.encode())
    frames = own.create_group("frames")
    for column in COLUMNS:
        _allocate(frames, column.name, (capacity, *column.shape), column.dtype)
    _allocate(frames, UNCHECKED, (capacity * mesh.num_nodes, 2), "f8")
    _allocate(frames, INFORMATION, (capacity * mesh.num_cells, 2), "f8")
    _write_own_mesh(own.create_group("mesh"), mesh)
    if mask is not None:
        own["mask"] = np.packbits(mask)
        own["mask"].attrs["shape"] = np.array(mask.shape, dtype=np.int64)


def datasets_of_frames(file: Any) -> Iterator[tuple[str, int]]:
    """Yield the names of the datasets that hold the frames, and their number of rows of a frame."""
    grid = file["VTKHDF"]
    for group, count in (("PointData", "NumberOfPoints"), ("CellData", "NumberOfCells")):
        for name in grid[group]:
            yield f"VTKHDF/{group}/{name}", int(grid[count][0])
    yield "VTKHDF/Steps/Values", 1
    for column in COLUMNS:
        yield f"fedic/frames/{column.name}", 1
    yield f"fedic/frames/{UNCHECKED}", int(grid["NumberOfPoints"][0])
    yield f"fedic/frames/{INFORMATION}", int(grid["NumberOfCells"][0])


def bytes_per_frame(mesh: Mesh, measure: StrainMeasure, *, drift: bool) -> int:
    """Return the size of a frame in a file."""
    size = 16 * (mesh.num_nodes + mesh.num_cells)
    size += sum(int(np.prod(column.shape, dtype=int)) * np.dtype(column.dtype).itemsize for column in COLUMNS)
    for field in fields(measure, drift=drift):
        size += field.rows(mesh) * field.components * np.dtype(field.dtype).itemsize
    return size


def read_mesh(file: Any) -> Mesh:
    """Return the mesh of a file."""
    grid, own = file["VTKHDF"], file["fedic/mesh"]
    types, offsets, connectivity = grid["Types"][:], grid["Offsets"][:], grid["Connectivity"][:]
    names = {cell.vtk_type: name for name, cell in CELL_TYPES.items()}
    cells = {}
    for start, stop in _runs(types):
        size = int(offsets[start + 1] - offsets[start])
        nodes = connectivity[offsets[start] : offsets[stop]]
        cells[names[int(types[start])]] = np.asarray(nodes, dtype=np.int64).reshape(-1, size)
    sets = {}
    for key in sorted(own["sets"], key=int):
        group = own["sets"][key]
        sets[str(group.attrs["name"])] = MeshSet(group["nodes"][:], group["cells"][:])
    points = grid["Points"][:, : int(own.attrs["dimensions"])]
    labels = {name: own[name][:] if name in own else None for name in ("node_labels", "cell_labels")}
    return Mesh(points, cells, sets, **labels)


def read_mask(file: Any) -> NDArray[np.bool_] | None:
    """Return the mask of a file; None if there is none."""
    if "mask" not in file["fedic"]:
        return None
    packed = file["fedic/mask"]
    shape = tuple(int(length) for length in packed.attrs["shape"])
    bits = np.unpackbits(packed[:], count=shape[0] * shape[1])
    return bits.reshape(shape).astype(bool)


def read_text(file: Any, name: str) -> Any:
    """Return the JSON types of a text of the group ``fedic``."""
    return json.loads(bytes(file["fedic"][name][()]))


def _write_mesh(grid: Any, mesh: Mesh) -> None:
    points = np.pad(mesh.points, ((0, 0), (0, 3 - mesh.points.shape[1])))
    sizes = np.concatenate([np.full(len(nodes), nodes.shape[1]) for nodes in mesh.cells.values()])
    types = [np.full(len(nodes), CELL_TYPES[name].vtk_type) for name, nodes in mesh.cells.items()]
    connectivity = np.concatenate([nodes.ravel() for nodes in mesh.cells.values()])
    for name, count in (
        ("NumberOfPoints", len(points)),
        ("NumberOfCells", len(sizes)),
        ("NumberOfConnectivityIds", len(connectivity)),
    ):
        grid[name] = np.array([count], dtype=np.int64)
    grid["Points"] = points
    grid["Connectivity"] = connectivity.astype(np.int64)
    grid["Offsets"] = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    grid["Types"] = np.concatenate(types).astype(np.uint8)


def _write_own_mesh(group: Any, mesh: Mesh) -> None:
    """Write what the grid of VTK does not hold: sets, labels and the number of coordinates."""
    group.attrs["dimensions"] = np.int64(mesh.points.shape[1])
    for name, labels in (("node_labels", mesh.node_labels), ("cell_labels", mesh.cell_labels)):
        if labels is not None:
            group[name] = labels
    sets = group.create_group("sets")
    for number, (name, found) in enumerate(mesh.sets.items()):
        entry = sets.create_group(str(number))
        entry.attrs["name"] = name
        entry["nodes"], entry["cells"] = found.nodes, found.cells


def _runs(types: NDArray[np.uint8]) -> Iterator[tuple[int, int]]:
    """Yield the ranges of equal values."""
    starts = [0, *(np.flatnonzero(np.diff(types)) + 1).tolist(), len(types)]
    yield from itertools.pairwise(starts)


def _shape(field: Field, rows: int) -> tuple[int, ...]:
    return (rows, field.components) if field.components > 1 else (rows,)


def _allocate(group: Any, name: str, shape: tuple[int, ...], dtype: str) -> None:
    """Create a dataset in one piece, without writing to it."""
    settings = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    settings.set_layout(h5py.h5d.CONTIGUOUS)
    settings.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    settings.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    kind = h5py.h5t.py_create(np.dtype(dtype), logical=True)
    h5py.h5d.create(group.id, name.encode(), kind, h5py.h5s.create_simple(shape), settings)
