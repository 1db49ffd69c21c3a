"""Reader of XDMF files, with their numbers in the file itself, in HDF5 files or in binary files."""

import math
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, ParseError

import numpy as np
from numpy.typing import NDArray

from fedic.io._mesh_file import Block, MeshFile, unreadable
from fedic.io.mesh_formats._numbers import numbers_of
from fedic.io.mesh_formats._set_fields import SET_PREFIX
from fedic.io.mesh_formats.hdf._arrays import MAX_NUMBERS, numbers
from fedic.io.mesh_formats.hdf._topologies import OF_NODES, SHORT, TOPOLOGIES, mixed_blocks

__all__ = ["read_xdmf"]

_NUMBERS = {"float": "f", "int": "i", "uint": "u", "char": "i", "uchar": "u", "short": "i"}
_MAX_DEPTH = 8


def read_xdmf(path: Path) -> MeshFile:
    """Read an XDMF file of version 2 or 3 with one unstructured grid, or the first of a collection in time.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file. The sets are the elements ``Set`` of nodes and cells, and the fields
        ``set:NAME``.

    Raises
    ------
    MeshError
        If the file is damaged or holds something else.
    """
    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        root = fromstring(path.read_bytes(), forbid_dtd=False)
        return _Reader(path, root).read()
    except ParseError as error:
        raise unreadable(path, f"it is not well-formed XML: {error}") from error
    except DefusedXmlException as error:
        raise unreadable(path, "it declares entities of XML, which are not read") from error
    except (ValueError, OSError, OverflowError, RuntimeError) as error:
        raise unreadable(path, str(error)) from error


class _Reader:
    """Reader of the grid of one file."""

    def __init__(self, path: Path, root: Element) -> None:
        self._path = path
        self._root = root

    def read(self) -> MeshFile:
        grid = self._grid()
        geometry, topology = self._part(grid, "Geometry"), self._part(grid, "Topology")
        contents = MeshFile(self._points(geometry), [])
        contents.blocks, order = self._blocks(topology)
        starts = np.cumsum([0, *(len(nodes) for _, nodes in contents.blocks)])

        def by_block(members: NDArray[np.int64]) -> list[NDArray[np.int64]]:
            places = np.flatnonzero(np.isin(order, members))
            parts = np.split(places, np.searchsorted(places, starts[1:-1]))
            return [part - start for part, start in zip(parts, starts, strict=False)]

        for each in grid.findall("Set"):
            members = self._item(self._part(each, "DataItem")).ravel().astype(np.int64)
            kind = (each.get("SetType") or each.get("Type") or "").lower()
            if kind == "node":
                contents.node_sets[each.get("Name", "")] = members
            elif kind == "cell":
                contents.cell_sets[each.get("Name", "")] = by_block(members)
        for each in grid.findall("Attribute"):
            name, centre = each.get("Name", ""), each.get("Center", "").lower()
            if name.startswith(SET_PREFIX) and centre in ("node", "cell"):
                members = np.flatnonzero(self._item(self._part(each, "DataItem")).ravel())
                name = name.removeprefix(SET_PREFIX)
                if centre == "node":
                    contents.node_sets[name] = members
                else:
                    contents.cell_sets[name] = by_block(members)
        return contents

    def _grid(self) -> Element:
        """Return the grid: the only one, or the first in time."""
        if self._root.tag != "Xdmf":
            raise ValueError(f"it is no XDMF file but XML of type {self._root.tag!r}")
        grids = self._root.findall("Domain/Grid")
        for _ in range(_MAX_DEPTH):
            if len(grids) != 1:
                raise ValueError(f"it holds {len(grids)} grids; save one of them alone")
            (grid,) = grids
            kind = (grid.get("GridType") or (grid.get("CollectionType") and "Collection") or "Uniform").lower()
            if kind == "uniform":
                return grid
            if kind == "collection" and (grid.get("CollectionType") or "").lower() == "temporal":
                grids = grid.findall("Grid")[:1]
            else:
                grids = grid.findall("Grid")
        raise ValueError("its grids are nested too deeply")

    def _part(self, parent: Element, name: str) -> Element:
        part = parent.find(name)
        if part is None:
            raise ValueError(f"the element {parent.tag} has no {name}")
        reference = part.get("Reference")
        if reference is None:
            return part
        text = ((part.text or "") if reference.upper() == "XML" else reference).strip()
        target = self._root.find("./" + text.removeprefix("/Xdmf/")) if text.startswith("/Xdmf/") else None
        if target is None:
            raise ValueError(f"the reference {text!r} leads nowhere")
        return target

    def _points(self, geometry: Element) -> NDArray[np.float64]:
        kind = (geometry.get("GeometryType") or geometry.get("Type") or "XYZ").upper()
        if kind in ("XYZ", "XY"):
            size = len(kind)
            values = self._item(self._part(geometry, "DataItem")).ravel()
            if values.size % size:
                raise ValueError(f"the geometry has {values.size} coordinates, no multiple of {size}")
            return values.reshape(-1, size).astype(np.float64)
        if kind in ("X_Y_Z", "X_Y"):
            columns = [self._item(each).ravel() for each in geometry.findall("DataItem")]
            if len(columns) != len(kind) // 2 + 1:
                raise ValueError(f"the geometry {kind} has {len(columns)} arrays")
            return np.column_stack(columns).astype(np.float64)
        raise ValueError(f"the geometry {kind} is not read; save coordinates XYZ")

    def _blocks(self, topology: Element) -> tuple[list[Block], NDArray[np.int64]]:
        """Return the cells by type, and the number in the file of each of them."""
        kind = (topology.get("TopologyType") or topology.get("Type") or "").lower()
        values = self._item(self._part(topology, "DataItem")).ravel().astype(np.int64)
        if kind == "mixed":
            return mixed_blocks(values)
        first, _, order = kind.partition("_")
        kind = "_".join(filter(None, [SHORT.get(first, first), order]))
        if kind in TOPOLOGIES:
            name, size, _ = TOPOLOGIES[kind]
        elif kind in OF_NODES:
            size = int(topology.get("NodesPerElement") or topology.get("NumberOfNodesPerElement") or 0)
            size = size or {"polyvertex": 1, "polyline": 2}.get(kind, 0)
            name = OF_NODES[kind].get(size, f"{kind} of {size} nodes")
        else:
            raise ValueError(f"the topology {kind!r} is not read; save triangles and quadrilaterals")
        if size < 1 or values.size % size:
            raise ValueError(f"the topology {kind} has {values.size} nodes, no multiple of {size}")
        nodes = values.reshape(-1, size)
        return [(name, nodes)], np.arange(len(nodes))

    def _item(self, item: Element) -> NDArray[Any]:
        if item.get("Reference") is not None:
            raise ValueError("an array refers to another one, which is not read")
        if (item.get("ItemType") or "Uniform").lower() != "uniform":
            raise ValueError(f"an array is made by {item.get('ItemType')}, which is not read; save its numbers")
        kind = (item.get("NumberType") or item.get("DataType") or "Float").lower()
        form, text = (item.get("Format") or "XML").upper(), (item.text or "").strip()
        shape = [int(each) for each in (item.get("Dimensions") or "").split()]
        count = math.prod(shape)
        if form == "XML":
            values = numbers_of(text.split(), np.float64 if kind == "float" else np.int64)
        elif form == "HDF":
            name, _, place = text.partition(":")
            import h5py

            with h5py.File(self._neighbour(name), "r") as file:
                values = np.asarray(numbers(file, place))
        elif form == "BINARY":
            size = int(item.get("Precision") or 4)
            order = ">" if (item.get("Endian") or "").lower() == "big" else "<"
            if not 0 <= count <= MAX_NUMBERS:
                raise ValueError(f"an array declares {count} numbers, more than the {MAX_NUMBERS} that are read")
            with self._neighbour(text).open("rb") as file:
                file.seek(int(item.get("Seek") or 0))
                content = file.read(count * size)
            if len(content) < count * size:
                raise ValueError(f"the file {text!r} is too short for {count} numbers")
            values = np.frombuffer(content, f"{order}{_NUMBERS.get(kind, 'i')}{size}")
        else:
            raise ValueError(f"the format {form!r} of an array is unknown")
        if shape and values.size != count:
            raise ValueError(f"an array declares {count} numbers but holds {values.size}")
        return values

    def _neighbour(self, name: str) -> Path:
        file = self._path.parent / name
        if not file.is_file():
            raise ValueError(f"it needs the file {name!r}, which does not exist")
        return file
