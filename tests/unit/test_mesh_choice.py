"""Choice of a part of a mesh file by name."""

from pathlib import Path

import meshio
import numpy as np
import pytest

import fedic
from fedic.io.meshes import split_choice
from scenes.meshes.gmsh_files import write_solid
from scenes.meshes.hdf_files import write_exodus, write_med
from scenes.meshes.plate import LEFT, POINTS, QUADS

SETS = {
    "left": fedic.MeshSet(nodes=LEFT),
    "lower": fedic.MeshSet(nodes=range(8)),
    "First": fedic.MeshSet(cells=[0]),
    "first": fedic.MeshSet(cells=[1, 2]),
    "Upper": fedic.MeshSet(cells=[3, 4, 5]),
}


@pytest.fixture
def plate(tmp_path: Path) -> Path:
    path = tmp_path / "plate.vtu"
    fedic.Mesh(POINTS[:, :2], {"quad": QUADS}, SETS).write(path)
    return path


@pytest.mark.parametrize(
    ("name", "cells"), [("First", [0]), ("first", [1, 2]), ("UPPER", [3, 4, 5]), ("lower", [0, 1, 2]), ("y-max", [])]
)
def test_a_name_chooses_cells_and_keeps_all_nodes(plate: Path, name: str, cells: list[int]) -> None:
    if not cells:
        with pytest.raises(fedic.MeshError, match=r"'y-max' chooses no surface cell"):
            fedic.read_mesh(f"{plate}#{name}")
        return
    mesh = fedic.read_mesh(f"{plate}#{name}")
    np.testing.assert_array_equal(mesh.points, POINTS[:, :2])
    np.testing.assert_array_equal(mesh.cells["quad"], QUADS[cells])


def test_the_sets_are_restricted_to_the_part(plate: Path) -> None:
    sets = fedic.read_mesh(f"{plate}#upper").sets
    assert {name: (each.nodes.tolist(), each.cells.tolist()) for name, each in sets.items()} == {
        "left": ([4, 8], []),
        "lower": ([4, 5, 6, 7], []),
        "First": ([4, 5], []),
        "first": ([5, 6, 7], []),
        "Upper": (list(range(4, 12)), [0, 1, 2]),
    }


def test_an_unknown_name_is_refused_with_the_names_of_the_file(plate: Path) -> None:
    with pytest.raises(fedic.MeshError, match="nothing named 'skin'") as error:
        fedic.read_mesh(f"{plate}#skin")
    for listed in ("First (1 surface cell)", "first (2 surface cells)", "lower (3 surface cells)", "left (no surface"):
        assert listed in str(error.value)
    with pytest.raises(fedic.MeshError, match="'FIRST' could mean any of 'First', 'first'"):
        fedic.read_mesh(f"{plate}#FIRST")
    with pytest.raises(fedic.MeshError, match="nothing follows the '#'"):
        fedic.read_mesh(f"{plate}#")
    with pytest.raises(fedic.MeshError, match="nothing named 'z-max'"):
        fedic.read_mesh(f"{plate}#z-max")  # the plate is flat
    with pytest.raises(fedic.MeshError, match=r"none\.vtu: there is no such mesh file"):
        fedic.read_mesh(plate.with_name("none.vtu#First"))


def test_a_file_whose_name_holds_a_number_sign_is_read(plate: Path) -> None:
    odd = plate.with_name("plate #1.vtu")
    plate.rename(odd)
    assert fedic.read_mesh(odd).num_cells == 6
    assert fedic.read_mesh(f"{odd}#first").num_cells == 2
    assert split_choice(f"{odd}#a#b") == (odd, "a#b")
    odd.rename(plate.with_name("plate"))
    plate.with_name("plate#b.vtu").write_text("")
    assert split_choice(plate.with_name("plate#b.vtu")) == (plate.with_name("plate#b.vtu"), None)


def test_named_blocks_and_numbered_blocks_of_exodus_are_chosen(tmp_path: Path) -> None:
    write_exodus(tmp_path / "plate.e", "NETCDF3_CLASSIC")
    assert list(fedic.read_mesh(tmp_path / "plate.e#plate").cells) == ["quad"]
    assert list(fedic.read_mesh(tmp_path / "plate.e#block 20").cells) == ["triangle"]


def test_groups_of_med_are_chosen(tmp_path: Path) -> None:
    write_med(tmp_path / "plate.med")
    mesh = fedic.read_mesh(tmp_path / "plate.med#TWO")
    np.testing.assert_array_equal(mesh.cells["quad"], QUADS[[0, 5]])


@pytest.mark.parametrize("choice", ["z-max", "Z-MAX", "top"])
@pytest.mark.parametrize("kind", ["hexahedron", "tetra", "wedge"])
def test_faces_of_solids_are_chosen_by_side_and_by_a_set_of_nodes(tmp_path: Path, kind: str, choice: str) -> None:
    path = tmp_path / "solid.vtu"
    write_block(path, kind, "top")
    mesh = fedic.read_mesh(f"{path}#{choice}")
    used = np.unique(np.concatenate([nodes.ravel() for nodes in mesh.cells.values()]))
    assert (mesh.points[used, 2] == 1.0).all()
    assert mesh.areas().sum() == pytest.approx(2.0)
    assert mesh.num_nodes == 12


def test_the_name_of_a_set_counts_before_that_of_a_side(tmp_path: Path) -> None:
    path = tmp_path / "solid.vtu"
    write_block(path, "hexahedron", "x-max")
    mesh = fedic.read_mesh(f"{path}#x-max")
    assert mesh.areas().sum() == pytest.approx(2.0)  # the set is that of the top


def test_a_file_of_solids_only_is_refused_with_the_names_of_faces(tmp_path: Path) -> None:
    path = tmp_path / "solid.vtu"
    write_block(path, "hexahedron", "top")
    with pytest.raises(fedic.MeshError, match=r"no surface cell .*cells found: hexahedron\)") as error:
        fedic.read_mesh(path)
    assert "solid.vtu#top" in str(error.value)
    assert "x-min (1 face of solids), x-max (1 face of solids), y-min (2 faces of solids)" in str(error.value)


def test_surface_cells_are_taken_where_a_file_holds_solids_too(tmp_path: Path) -> None:
    write_solid(tmp_path / "solid.msh")
    assert fedic.read_mesh(tmp_path / "solid.msh").num_cells == 6
    write_solid(tmp_path / "solid.msh", groups=False)
    mesh = fedic.read_mesh(tmp_path / "solid.msh#y-min")
    assert mesh.areas().sum() == pytest.approx(3.0)
    with pytest.raises(fedic.MeshError, match="'solid' chooses no surface cell but 12 hexahedron cells"):
        fedic.read_mesh(tmp_path / "solid.msh#solid")


def write_block(path: Path, kind: str, top: str) -> None:
    """Write two cubes beside each other, or four wedges, or twelve tetrahedra, and a set of the nodes with z = 1."""
    points = np.array([(x, y, z) for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0)])
    cubes = np.array([[i, i + 1, i + 4, i + 3, i + 6, i + 7, i + 10, i + 9] for i in (0, 1)])
    wedges = np.concatenate([cubes[:, [0, 1, 2, 4, 5, 6]], cubes[:, [0, 2, 3, 4, 6, 7]]])
    tetrahedra = np.concatenate([wedges[:, [0, 1, 2, 3]], wedges[:, [1, 2, 3, 4]], wedges[:, [2, 3, 4, 5]]])
    cells = {"hexahedron": cubes, "wedge": wedges, "tetra": tetrahedra}[kind]
    data = {f"set:{top}": (points[:, 2] == 1.0).astype(int)}
    meshio.write(path, meshio.Mesh(points, [(kind, cells)], point_data=data))
