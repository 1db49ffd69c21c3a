"""Writing meshes and reading them back, and the named sets of mesh files."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import fedic
from fedic import CELL_TYPES, MeshSet

SETS = {"left": MeshSet(nodes=[0, 1, 2]), "two_cells": MeshSet(cells=[1, 3])}


def curved_mesh(cell: str) -> fedic.Mesh:
    mesh = fedic.rectangle_mesh((0.1, 0.2, 3.3, 2.1), 1.0, cell)
    x, y = mesh.points.T
    points = np.column_stack([x, y, 0.1 * x**2 + 1.0 / 3.0])
    return fedic.Mesh(points, mesh.cells, SETS)


def assert_same(read: fedic.Mesh, mesh: fedic.Mesh, tolerance: float = 0.0) -> None:
    np.testing.assert_allclose(read.points, mesh.points, rtol=0.0, atol=tolerance)
    assert list(read.cells) == list(mesh.cells)
    for name, nodes in mesh.cells.items():
        np.testing.assert_array_equal(read.cells[name], nodes)
    assert read.sets == mesh.sets


@pytest.mark.parametrize(
    ("cell", "suffix"),
    [
        (cell, suffix)
        for suffix in (".vtu", ".inp", ".msh", ".vtk", ".xdmf", ".med")
        for cell in CELL_TYPES
        if (cell, suffix) != ("quad9", ".med")
    ],
)
def test_a_mesh_reads_back_the_same(tmp_path: Path, cell: str, suffix: str) -> None:
    path = tmp_path / f"mesh{suffix}"
    for mesh in (curved_mesh(cell), fedic.rectangle_mesh((0.1, 0.2, 3.3, 2.1), 1.0, cell).with_sets(SETS)):
        mesh.write(path)
        assert_same(fedic.read_mesh(path), mesh)
    beside = ["mesh.h5"] if suffix == ".xdmf" else []
    assert sorted(each.name for each in tmp_path.iterdir()) == [*beside, path.name]


@pytest.mark.parametrize("suffix", [".vtu", ".inp", ".med", ".xdmf"])
def test_sets_over_several_cell_types_read_back_the_same(tmp_path: Path, suffix: str) -> None:
    points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0], [9.0, 9.0]]
    cells = {"quad": [[0, 1, 2, 3]], "triangle": [[1, 4, 5], [1, 5, 2]]}
    sets = {"a": MeshSet(cells=[0, 2]), "b": MeshSet(nodes=[6], cells=[1]), "c": MeshSet(nodes=[6, 0])}
    mesh = fedic.Mesh(points, cells, sets)
    mesh.write(tmp_path / f"mesh{suffix}")
    assert_same(fedic.read_mesh(tmp_path / f"mesh{suffix}"), mesh)


def test_names_of_sets_are_escaped_in_vtu(tmp_path: Path) -> None:
    mesh = fedic.rectangle_mesh((0, 0, 2, 1), 1.0).with_sets({'<a & "b">': MeshSet(nodes=[1])})
    mesh.write(tmp_path / "mesh.vtu")
    assert_same(fedic.read_mesh(tmp_path / "mesh.vtu"), mesh)


@pytest.mark.parametrize(
    ("name", "cell", "sets", "message"),
    [
        ("mesh.stl", "triangle", {}, "'.stl' does not hold"),
        ("mesh.obj", "quad8", {}, "cannot be written as '.obj'"),
        ("mesh.obj", "quad", SETS, r"does not hold the named sets of this mesh \(left, two_cells\)"),
        ("mesh.mesh", "quad8", {}, "'.mesh' does not hold this mesh"),
        ("mesh.med", "quad9", {}, "cannot be written as '.med'"),
        ("mesh.bdf", "quad", SETS, "'.bdf' does not hold the named sets"),
        ("mesh.ele", "triangle", {}, "cannot be written as '.ele' .the format holds volumes only"),
        ("mesh.vtk", "quad", {"two words": MeshSet(nodes=[0])}, "cannot be written as '.vtk'"),
        ("mesh.xyz", "quad", {}, "cannot be written as '.xyz'"),
        ("mesh", "quad", {}, "cannot be written as ''"),
    ],
)
def test_a_format_that_does_not_hold_the_mesh_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, cell: str, sets: dict[str, MeshSet], message: str
) -> None:
    path = tmp_path / name
    path.write_text("as before")
    with pytest.raises(fedic.MeshError, match=message) as error:
        fedic.rectangle_mesh((0.1, 0.2, 3.3, 2.1), 1.0, cell).with_sets(sets).write(path)
    assert str(error.value).startswith(f"{path}: ")
    assert [each.name for each in tmp_path.iterdir()] == [name]
    assert path.read_text() == "as before"
    assert capfd.readouterr() == ("", "")


def test_a_folder_that_does_not_exist_is_named(tmp_path: Path) -> None:
    with pytest.raises(fedic.FedicError, match=r"none does not exist"):
        fedic.rectangle_mesh((0, 0, 2, 1), 1.0).write(tmp_path / "none" / "mesh.vtu")


ABAQUS = """\
*Heading
*Part, name=Plate
*Node, nset=all nodes
      10,   0.,   0.
      20,   1.,   0.
      30,   1.,   1.
      40,   0.,   1.
*Node
      50,   2.,   0.
*Element, type=CPS4, elset=square
1, 10, 20, 30, 40
*Element, type=CPE3
2, 20, 50, 30
*Nset, nset=left
10, 40
*Nset, nset=Left
20
*Nset, nset=ranges, generate
10, 30, 10
50, 51
*Nset, nset=of both
left, 50
*Nset, nset=square nodes, elset=square
*Elset, elset=everything, generate
1, 2, 1
*Elset, elset=nested
square,
*Elset, elset=left
2,
*End Part
*Assembly, name=Assembly
*Instance, name=Plate-1, part=Plate
*End Instance
*Node
      1,   7.,   7.,   0.
*Nset, nset=reference
1,
*Nset, nset=of assembly, instance=Plate-1
50,
*Nset, nset=ranges, instance=Plate-1
10,
*Elset, elset=elsewhere, instance=Other-1
1,
*End Assembly
"""


def test_sets_of_abaqus_are_read(tmp_path: Path) -> None:
    path = tmp_path / "plate.inp"
    path.write_text(ABAQUS)
    sets = fedic.read_mesh(path).sets
    assert {name: (each.nodes.tolist(), each.cells.tolist()) for name, each in sets.items()} == {
        "all nodes": ([0, 1, 2, 3], []),
        "left": ([0, 1, 3], [1]),
        "ranges": ([0, 1, 2, 4], []),
        "of both": ([0, 1, 3, 4], []),
        "square nodes": ([0, 1, 2, 3], []),
        "of assembly": ([4], []),
        "Assembly.ranges": ([0], []),
        "square": ([0, 1, 2, 3], [0]),
        "everything": ([0, 1, 2, 3, 4], [0, 1]),
        "nested": ([0, 1, 2, 3], [0]),
    }


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("*Nset, nset=a\nb\n*Nset, nset=b\na", "set . contains itself"),
        ("*Nset, nset=a\nnone", "contains 'none', which is neither a label nor a set of nodes"),
        ("*Nset, nset=a, elset=none", "contains 'none', which is neither a label nor a set of elements"),
        ("*Nset, nset=a, generate\n1, x", "set a has a line that is not first, last, increment"),
    ],
)
def test_sets_of_abaqus_that_make_no_sense_are_refused(tmp_path: Path, line: str, message: str) -> None:
    path = tmp_path / "plate.inp"
    path.write_text(ABAQUS.replace("*End Part", f"{line}\n*End Part"))
    with pytest.raises(fedic.MeshError, match=message):
        fedic.read_mesh(path)


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_physical_groups_of_gmsh_are_read(tmp_path: Path, gmsh: Any, version: float) -> None:
    gmsh.initialize([], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        first = gmsh.model.occ.addRectangle(0, 0, 0, 3, 2)
        second = gmsh.model.occ.addRectangle(3, 0, 0, 1, 2)
        gmsh.model.occ.fragment([(2, first)], [(2, second)])
        gmsh.model.occ.synchronize()
        lines = gmsh.model.getEntitiesInBoundingBox(-0.1, -0.1, -0.1, 4.1, 0.1, 0.1, dim=1)
        gmsh.model.addPhysicalGroup(1, [tag for _, tag in lines], 7, "bottom")
        gmsh.model.addPhysicalGroup(2, [first], 7, "wide")
        gmsh.model.addPhysicalGroup(2, [second], 8, "narrow")
        gmsh.model.mesh.generate(2)
        gmsh.write(str(tmp_path / "mesh.msh"))
    finally:
        gmsh.finalize()
    mesh = fedic.read_mesh(tmp_path / "mesh.msh")
    assert set(mesh.sets) == {"bottom", "wide", "narrow"}
    np.testing.assert_array_equal(mesh.sets["bottom"].nodes, np.flatnonzero(mesh.points[:, 1] == 0.0))
    assert mesh.sets["bottom"].cells.size == 0
    areas = mesh.areas()
    assert areas[mesh.sets["wide"].cells].sum() == pytest.approx(6.0)
    assert areas[mesh.sets["narrow"].cells].sum() == pytest.approx(2.0)


def test_sets_of_lines_and_points_become_sets_of_nodes(tmp_path: Path) -> None:
    points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
    cells = [("line", [[0, 1]]), ("quad", [[0, 1, 2, 3]])]
    data = {"set:edge": [np.array([1]), np.array([0])], "set:all": [np.array([1]), np.array([1])]}
    meshio.write(tmp_path / "mesh.vtu", meshio.Mesh(points, cells, cell_data=data))
    sets = fedic.read_mesh(tmp_path / "mesh.vtu").sets
    assert (sets["edge"].nodes.tolist(), sets["edge"].cells.tolist()) == ([0, 1], [])
    assert (sets["all"].nodes.tolist(), sets["all"].cells.tolist()) == ([0, 1, 2, 3], [0])
