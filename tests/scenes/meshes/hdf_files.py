"""Files of MED, XDMF and Exodus."""

from pathlib import Path
from typing import Any

import numpy as np

from scenes.meshes.plate import LEFT, MIXED_QUADS, POINTS, QUADS, TRIANGLES

__all__ = [
    "write_exodus",
    "write_exodus_solid",
    "write_med",
    "write_two_med",
    "write_xdmf",
    "write_xdmf_2",
    "write_xdmf_mixed",
    "write_xdmf_structured",
]


def write_med(path: Path, meshes: tuple[str, ...] = ("plate",)) -> None:
    """Write the quads with groups PLATE (all), TWO (the first and the last) and LEFT (nodes), as Salome does."""
    import h5py

    with h5py.File(path, "w") as file:
        for name in meshes:
            mesh = file.create_group(f"ENS_MAA/{name}")
            mesh.attrs.update({"ESP": 3, "DIM": 2, "TYP": 0})
            step = mesh.create_group("-0000000000000000001-0000000000000000001")
            coordinates = step.create_dataset("NOE/COO", data=POINTS.ravel(order="F"))
            coordinates.attrs["NBR"] = len(POINTS)
            step.create_dataset("NOE/FAM", data=np.isin(np.arange(len(POINTS)), LEFT).astype("i4"))
            nodes = step.create_dataset("MAI/QU4/NOD", data=QUADS.ravel(order="F") + 1)
            nodes.attrs["NBR"] = len(QUADS)
            step.create_dataset("MAI/QU4/FAM", data=np.array([-2, -1, -1, -1, -1, -2]))
            lines = step.create_dataset("MAI/SE2/NOD", data=np.array([1, 2]))
            lines.attrs["NBR"] = 1
            families = file.create_group(f"FAS/{name}")
            families.create_group("FAMILLE_ZERO").attrs["NUM"] = 0
            for kind, number, groups in (
                ("NOEUD", 1, ["LEFT"]),
                ("ELEME", -1, ["PLATE"]),
                ("ELEME", -2, ["PLATE", "TWO"]),
            ):
                family = families.create_group(f"{kind}/FAM_{number}")
                family.attrs["NUM"] = number
                names = [list(each.encode().ljust(80, b"\0")) for each in groups]
                family.create_dataset("GRO/NOM", data=np.array(names, dtype="i1"))
                family["GRO"].attrs["NBR"] = len(groups)


def write_two_med(path: Path) -> None:
    write_med(path, ("plate", "other"))


class _Items:
    """Writer of arrays of an XDMF file."""

    def __init__(self, path: Path, form: str) -> None:
        self.path, self.form, self.count = path, form, 0

    def item(self, values: Any) -> str:
        values = np.asarray(values)
        self.count += 1
        shape = " ".join(map(str, values.shape))
        kind = "Float" if values.dtype.kind == "f" else "Int"
        text = " ".join(map(repr, values.ravel().tolist()))
        if self.form == "HDF":
            import h5py

            with h5py.File(self.path.with_suffix(".h5"), "a") as file:
                file[f"data{self.count}"] = values
            text = f"{self.path.stem}.h5:/data{self.count}"
        elif self.form == "Binary":
            text = f"{self.path.stem}{self.count}.bin"
            values.tofile(self.path.parent / text)
        return (
            f'<DataItem DataType="{kind}" Precision="{values.itemsize}" Dimensions="{shape}" Format="{self.form}">'
            f"{text}</DataItem>\n"
        )


def write_xdmf(path: Path, form: str) -> None:
    items = _Items(path, form)
    is_left = np.isin(np.arange(len(POINTS)), LEFT).astype(int)
    path.write_text(
        '<?xml version="1.0"?>\n<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>\n'
        '<Xdmf Version="3.0"><Domain><Grid Name="mesh" GridType="Uniform">\n'
        f'<Geometry GeometryType="XY">{items.item(POINTS[:, :2])}</Geometry>\n'
        f'<Topology TopologyType="Quadrilateral">{items.item(QUADS)}</Topology>\n'
        f'<Attribute Name="set:left" Center="Node">{items.item(is_left)}</Attribute>\n'
        "</Grid></Domain></Xdmf>\n"
    )


def write_xdmf_2(path: Path) -> None:
    items = _Items(path, "XML")
    path.write_text(
        '<Xdmf Version="2.0"><Domain><Grid GridType="Collection" CollectionType="Temporal">\n<Grid Name="first">\n'
        f'<Time Value="0"/><Topology TopologyType="Quad" NumberOfElements="6">{items.item(QUADS)}</Topology>\n'
        f'<Geometry GeometryType="XYZ">{items.item(POINTS)}</Geometry>\n'
        f'<Set Name="left" SetType="Node">{items.item(LEFT)}</Set>\n'
        f'<Set Name="two" SetType="Cell">{items.item([0, 5])}</Set>\n'
        "</Grid></Grid></Domain></Xdmf>\n"
    )


def write_xdmf_mixed(path: Path) -> None:
    items = _Items(path, "HDF")
    mixed = [n for nodes in MIXED_QUADS.tolist() for n in (5, *nodes)]
    mixed += [2, 2, 0, 1]
    mixed += [n for nodes in TRIANGLES.tolist() for n in (4, *nodes)]
    path.write_text(
        '<Xdmf Version="3.0"><Domain><Grid>\n'
        f'<Geometry GeometryType="XYZ">{items.item(POINTS)}</Geometry>\n'
        f'<Topology TopologyType="Mixed">{items.item(mixed)}</Topology>\n'
        "</Grid></Domain></Xdmf>\n"
    )


def write_xdmf_structured(path: Path) -> None:
    items = _Items(path, "XML")
    path.write_text(
        '<Xdmf Version="3.0"><Domain><Grid>\n'
        f'<Geometry GeometryType="XYZ">{items.item(POINTS)}</Geometry>\n'
        f'<Topology TopologyType="2DSMesh">{items.item([3, 4])}</Topology>\n'
        "</Grid></Domain></Xdmf>\n"
    )


def _texts(file: Any, variable: str, dimension: str, names: list[str]) -> None:
    table = file.createVariable(variable, "S1", (dimension, "len_name"))
    for row, name in enumerate(names):
        table[row] = np.frombuffer(name.encode().ljust(33, b"\0"), "S1")


def _coordinates(file: Any, points: Any) -> None:
    file.createDimension("len_name", 33)
    file.createDimension("num_nodes", len(points))
    for axis, values in zip("xyz", np.asarray(points).T, strict=True):
        file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = values


def _block(file: Any, number: int, kind: str, nodes: Any) -> None:
    nodes = np.asarray(nodes)
    file.createDimension(f"num_el_in_blk{number}", len(nodes))
    file.createDimension(f"num_nod_per_el{number}", nodes.shape[1])
    table = file.createVariable(f"connect{number}", "i4", (f"num_el_in_blk{number}", f"num_nod_per_el{number}"))
    table.elem_type = kind
    table[:] = nodes + 1


def write_exodus(path: Path, form: str) -> None:
    """Write shells in two blocks, the first with a name, and a set of nodes."""
    import netCDF4

    with netCDF4.Dataset(str(path), "w", format=form) as file:
        _coordinates(file, POINTS)
        file.createDimension("num_el_blk", 2)
        _texts(file, "eb_names", "num_el_blk", ["PLATE", ""])
        file.createVariable("eb_prop1", "i4", ("num_el_blk",))[:] = [10, 20]
        _block(file, 1, "SHELL4", MIXED_QUADS)
        _block(file, 2, "TRISHELL3", TRIANGLES)
        file.createDimension("num_node_sets", 1)
        _texts(file, "ns_names", "num_node_sets", ["LEFT"])
        file.createDimension("num_nod_ns1", len(LEFT))
        file.createVariable("node_ns1", "i4", ("num_nod_ns1",))[:] = LEFT + 1


def write_exodus_solid(path: Path) -> None:
    """Write solids of 20 nodes, whose sides with z = 2 are a side set."""
    import netCDF4

    places: dict[tuple[float, float, float], int] = {}

    def node(x: float, y: float, z: float) -> int:
        return places.setdefault((x, y, z), len(places))

    elements = []
    for x, y in ((x, y) for y in range(2) for x in range(3)):
        corners = [(x + a, y + b, c) for c in (0.0, 2.0) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        edges = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)]
        middles = [np.mean([corners[a], corners[b]], axis=0).tolist() for a, b in edges]
        elements.append([node(*each) for each in corners + middles])
    with netCDF4.Dataset(str(path), "w", format="NETCDF3_64BIT_OFFSET") as file:
        _coordinates(file, list(places))
        file.createDimension("num_el_blk", 1)
        _block(file, 1, "HEX20", elements)
        file.createDimension("num_side_sets", 1)
        _texts(file, "ss_names", "num_side_sets", ["TOP"])
        file.createDimension("num_side_ss1", 6)
        file.createVariable("elem_ss1", "i4", ("num_side_ss1",))[:] = np.arange(6) + 1
        file.createVariable("side_ss1", "i4", ("num_side_ss1",))[:] = 6
