"""Labels of nodes and cells: the numbers of the program that made the mesh."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import fedic

ABAQUS = """*HEADING
*NODE
101, 0., 0.
205, 1., 0.
103, 1., 1.
4, 0., 1.
77, 2., 0.
78, 2., 1.
*ELEMENT, TYPE=CPS4, ELSET=LEFT
12, 101, 205, 103, 4
*ELEMENT, TYPE=CPS3, ELSET=RIGHT
9, 205, 77, 78
3, 205, 78, 103
"""
NASTRAN = """BEGIN BULK
GRID,101,,0.,0.,0.
GRID,205,,1.,0.,0.
GRID,103,,1.,1.,0.
GRID,4,,0.,1.,0.
GRID,77,,2.,0.,0.
GRID,78,,2.,1.,0.
CQUAD4,12,1,101,205,103,4
CTRIA3,9,1,205,77,78
CTRIA3,3,1,205,78,103
ENDDATA
"""
GMSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
6
101 0 0 0
205 1 0 0
103 1 1 0
4 0 1 0
77 2 0 0
78 2 1 0
$EndNodes
$Elements
4
1 1 2 1 1 101 205
12 3 2 1 1 101 205 103 4
9 2 2 1 2 205 77 78
3 2 2 1 2 205 78 103
$EndElements
"""
ANSYS = """/PREP7
ET,1,182
N,101,0.,0.
N,205,1.,0.
N,103,1.,1.
N,4,0.,1.
N,77,2.,0.
N,78,2.,1.
EN,12,101,205,103,4
EN,9,205,77,78,78
EN,3,205,78,103,103
"""
FILES = {"plate.inp": ABAQUS, "plate.bdf": NASTRAN, "plate.msh": GMSH, "plate.cdb": ANSYS}
NODES, CELLS = [101, 205, 103, 4, 77, 78], [12, 9, 3]


@pytest.fixture
def mesh(tmp_path: Path) -> fedic.Mesh:
    (tmp_path / "plate.inp").write_text(ABAQUS)
    return fedic.read_mesh(tmp_path / "plate.inp")


@pytest.mark.parametrize("name", FILES)
def test_labels_are_those_of_the_file(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(FILES[name])
    mesh = fedic.read_mesh(tmp_path / name)
    assert mesh.node_labels is not None
    assert mesh.cell_labels is not None
    assert mesh.node_labels.tolist() == NODES
    assert mesh.cell_labels.tolist() == CELLS
    assert mesh.node_labels.dtype == mesh.cell_labels.dtype == np.int64
    by_label = dict(zip(NODES, mesh.points[:, :2].tolist(), strict=True))
    assert by_label[77] == [2.0, 0.0]


def test_labels_follow_the_order_of_the_cells(tmp_path: Path) -> None:
    """Cells of one type are one block, wherever the file has them."""
    text = ABAQUS + "*ELEMENT, TYPE=CPS4\n2, 4, 103, 301, 300\n*NODE\n300, 0., 2.\n301, 1., 2.\n"
    (tmp_path / "plate.inp").write_text(text)
    mesh = fedic.read_mesh(tmp_path / "plate.inp")
    assert mesh.cell_labels is not None
    assert list(mesh.cells) == ["quad", "triangle"]
    assert mesh.cell_labels.tolist() == [12, 2, 9, 3]


def test_a_part_of_a_file_has_the_labels_of_its_cells(tmp_path: Path) -> None:
    (tmp_path / "plate.inp").write_text(ABAQUS)
    part = fedic.read_mesh(f"{tmp_path / 'plate.inp'}#RIGHT")
    assert part.node_labels is not None
    assert part.cell_labels is not None
    assert part.node_labels.tolist() == NODES
    assert part.cell_labels.tolist() == [9, 3]


def test_a_cell_given_twice_has_the_label_of_the_copy_that_is_kept(tmp_path: Path) -> None:
    (tmp_path / "plate.inp").write_text(ABAQUS + "*ELEMENT, TYPE=CPS4\n50, 101, 205, 103, 4\n")
    mesh = fedic.read_mesh(tmp_path / "plate.inp")
    assert mesh.cell_labels is not None
    assert mesh.cell_labels.tolist() == CELLS


def test_faces_of_solids_have_no_labels_but_their_nodes_have(tmp_path: Path) -> None:
    corners = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)
    nodes = "".join(f"{10 * k + 5}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(corners))
    element = "1, " + ", ".join(str(10 * k + 5) for k in (0, 4, 6, 2, 1, 5, 7, 3))
    (tmp_path / "cube.inp").write_text(f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8\n{element}\n")
    mesh = fedic.read_mesh(f"{tmp_path / 'cube.inp'}#z-max")
    assert mesh.node_labels is not None
    assert mesh.node_labels.tolist() == list(range(5, 85, 10))
    assert mesh.cell_labels is None


def test_labels_of_several_instances_are_not_kept(tmp_path: Path) -> None:
    part = ABAQUS.replace("*HEADING\n", "*PART, NAME=PLATE\n") + "*END PART\n"
    one, two = ("*INSTANCE, NAME=A, PART=PLATE\n*END INSTANCE\n", "*INSTANCE, NAME=B, PART=PLATE\n5.\n*END INSTANCE\n")
    for name, instances in (("one", one), ("two", one + two)):
        (tmp_path / f"{name}.inp").write_text(f"{part}*ASSEMBLY, NAME=ALL\n{instances}*END ASSEMBLY\n")
    assert fedic.read_mesh(tmp_path / "one.inp").node_labels is not None
    both = fedic.read_mesh(tmp_path / "two.inp")
    assert both.num_nodes == 2 * len(NODES)
    assert both.node_labels is both.cell_labels is None


def test_exodus_files_have_labels(tmp_path: Path) -> None:
    import netCDF4 as netcdf  # noqa: N813 - the package is called so

    with netcdf.Dataset(tmp_path / "plate.e", "w") as file:
        sizes = {"num_nodes": 6, "num_el_blk": 2, "num_elem": 3, "a": 1, "b": 2, "four": 4, "three": 3}
        for name, size in sizes.items():
            file.createDimension(name, size)
        for name, values in (("coordx", [0, 1, 1, 0, 2, 2]), ("coordy", [0, 0, 1, 1, 0, 1])):
            file.createVariable(name, "f8", ("num_nodes",))[:] = values
        blocks = (
            ("connect1", "QUAD4", ("a", "four"), [[1, 2, 3, 4]]),
            ("connect2", "TRI3", ("b", "three"), [[2, 5, 6], [2, 6, 3]]),
        )
        for name, kind, dimensions, nodes in blocks:
            file.createVariable(name, "i4", dimensions)[:] = nodes
            file.variables[name].elem_type = kind
        file.createVariable("node_num_map", "i4", ("num_nodes",))[:] = NODES
        file.createVariable("elem_num_map", "i4", ("num_elem",))[:] = CELLS
    mesh = fedic.read_mesh(tmp_path / "plate.e")
    assert mesh.node_labels is not None
    assert mesh.cell_labels is not None
    assert (mesh.node_labels.tolist(), mesh.cell_labels.tolist()) == (NODES, CELLS)


def test_med_files_that_number_all_their_cells_have_labels(mesh: fedic.Mesh, tmp_path: Path) -> None:
    import h5py

    mesh.with_sets({}).write(tmp_path / "plate.med")

    def number(code: str, labels: list[int]) -> fedic.Mesh:
        with h5py.File(tmp_path / "plate.med", "r+") as file:
            (whole,) = file["ENS_MAA"].values()
            step = whole if "NOE" in whole else next(iter(whole.values()))
            (step["MAI"][code] if code else step["NOE"])["NUM"] = labels
        return fedic.read_mesh(tmp_path / "plate.med")

    np.testing.assert_array_equal(number("", NODES).node_labels, NODES)
    assert number("QU4", CELLS[:1]).cell_labels is None
    np.testing.assert_array_equal(number("TR3", CELLS[1:]).cell_labels, CELLS)


def test_abaqus_files_keep_the_labels(mesh: fedic.Mesh, tmp_path: Path) -> None:
    mesh.write(tmp_path / "written.inp")
    again = fedic.read_mesh(tmp_path / "written.inp")
    assert "\n205, 1.0, 0.0, 0.0\n" in (tmp_path / "written.inp").read_text()
    np.testing.assert_array_equal(again.node_labels, NODES)
    np.testing.assert_array_equal(again.cell_labels, CELLS)
    np.testing.assert_array_equal(again.points, mesh.points)
    assert again.sets == mesh.sets
    mesh.write(tmp_path / "written.vtu")
    assert fedic.read_mesh(tmp_path / "written.vtu").node_labels is None


def test_transformations_and_pickle_keep_the_labels(mesh: fedic.Mesh) -> None:
    moved = mesh.translated((1, 2)).scaled(2.0).rotated((0, 0, 0.3)).with_sets({})
    for other in (moved, pickle.loads(pickle.dumps(mesh))):
        np.testing.assert_array_equal(other.node_labels, NODES)
        np.testing.assert_array_equal(other.cell_labels, CELLS)


def test_nodes_of_a_cut_get_labels_after_the_largest(mesh: fedic.Mesh) -> None:
    cut = mesh.split([(1, 0), (1, 1)])
    np.testing.assert_array_equal(cut.node_labels, [*NODES, 206, 207])
    joined = cut.merge_nodes(1e-6)
    np.testing.assert_array_equal(joined.node_labels, NODES)
    np.testing.assert_array_equal(joined.cell_labels, CELLS)


def test_a_mesh_made_by_hand_has_the_labels_given() -> None:
    points, cells = [[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]}
    bare = fedic.Mesh(points, cells)
    assert bare.node_labels is bare.cell_labels is None
    mesh = fedic.Mesh(points, cells, node_labels=np.array([7, 8, 2], dtype=np.int32), cell_labels=[5])
    np.testing.assert_array_equal(mesh.node_labels, [7, 8, 2])
    np.testing.assert_array_equal(mesh.cell_labels, [5])


@pytest.mark.parametrize(
    ("node_labels", "message"),
    [
        ([1, 2], "as many node labels; 2 were given"),
        ([1, 2, 0], "node 2 has the label 0"),
        ([3, 1, 3], "nodes 0 and 2 have the same label 3"),
        ([1.5, 2, 3], "node_labels must be a 1-dimensional array of integers"),
        ([[1, 2, 3]], "node_labels must be a 1-dimensional array of integers"),
        ([1, 2, 2.0**60], "labels are integers from 1 to 2\\^53"),
    ],
)
def test_labels_that_cannot_be_are_refused(node_labels: object, message: str) -> None:
    with pytest.raises(fedic.MeshError, match=message):
        fedic.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]}, node_labels=node_labels)  # type: ignore[arg-type]
