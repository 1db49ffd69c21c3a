"""Cells that a file holds twice, and faces of solids."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fedic
from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_parts import boundary_faces, check_whole, chosen, without_repeated_cells
from scenes.meshes.gmsh_files import write_plate, write_solid
from scenes.meshes.plate import POINTS, QUADS


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_a_surface_in_two_groups_is_read_once_and_stays_in_both(tmp_path: Path, version: float) -> None:
    write_plate(tmp_path / "plate.msh", version, False, {})
    mesh = fedic.read_mesh(tmp_path / "plate.msh")
    assert mesh.num_cells == 6
    for name in ("plate", "also"):
        np.testing.assert_array_equal(mesh.sets[name].cells, np.arange(6))


def test_faces_between_partitions_of_a_solid_are_left_out(tmp_path: Path) -> None:
    write_solid(tmp_path / "solid.msh", partitions=3)
    assert fedic.read_mesh(tmp_path / "solid.msh").areas().sum() == pytest.approx(22.0)


@pytest.mark.parametrize(
    ("second", "kept"),
    [
        (("quad", [[0, 1, 5, 4]]), ("quad", [[0, 1, 5, 4]])),
        (("quad", [[4, 5, 1, 0]]), ("quad", [[0, 1, 5, 4]])),
        (("quad8", [[0, 1, 5, 4, 12, 13, 14, 15]]), ("quad8", [[0, 1, 5, 4, 12, 13, 14, 15]])),
    ],
)
def test_two_cells_with_the_same_corners_are_one(
    second: tuple[str, list[list[int]]], kept: tuple[str, list[list[int]]]
) -> None:
    blocks = [("quad", np.array([[0, 1, 5, 4], [1, 2, 6, 5]])), (second[0], np.array(second[1]))]
    none, first = np.empty(0, dtype=np.int64), np.zeros(1, dtype=np.int64)
    contents = MeshFile(np.zeros((16, 3)), blocks, cell_sets={"a": [first, none], "b": [none, first]})
    read = without_repeated_cells(contents)
    cells = read.surface_cells()
    assert kept[1][0] in cells[kept[0]].tolist()
    assert sum(map(len, cells.values())) == 2
    sets = read.sets()
    assert sets["a"].cells.tolist() == sets["b"].cells.tolist()


def test_a_triangle_given_as_a_quad_with_a_repeated_node_too_is_one_cell() -> None:
    blocks = [("quad", np.array([[0, 1, 5, 5]])), ("triangle", np.array([[5, 0, 1], [1, 6, 5]]))]
    cells = without_repeated_cells(MeshFile(POINTS, blocks)).surface_cells()
    assert sum(map(len, cells.values())) == 2


@given(
    st.lists(st.tuples(st.integers(0, 5), st.permutations(range(4)), st.integers(0, 1), st.sampled_from("ab"))),
)
def test_repetition_changes_neither_the_cells_nor_the_members_of_sets(
    copies: list[tuple[int, list[int], int, str]],
) -> None:
    """Copies of cells of a plate, in any order of nodes, in two blocks and two sets."""
    rows: list[list[list[int]]] = [QUADS.tolist(), []]
    members: dict[str, list[list[int]]] = {"a": [[], []], "b": [[], []]}
    expected: dict[str, set[int]] = {"a": set(), "b": set()}
    for cell, order, block, name in copies:
        rows[block].append(QUADS[cell][order].tolist())
        members[name][block].append(len(rows[block]) - 1)
        expected[name].add(cell)
    blocks = [("quad", np.array(each, dtype=np.int64).reshape(-1, 4)) for each in rows]
    sets = {name: [np.array(each, dtype=np.int64) for each in parts] for name, parts in members.items()}
    read = without_repeated_cells(MeshFile(POINTS, blocks, cell_sets=sets))
    assert read.surface_cells()["quad"].tolist() == QUADS.tolist()
    assert {name: set(read.sets()[name].cells.tolist()) if expected[name] else set() for name in expected} == expected


@pytest.mark.parametrize(("order", "incomplete", "cell"), [(1, False, "quad"), (2, True, "quad8"), (2, False, "quad9")])
def test_faces_of_hexahedra_have_the_nodes_of_gmsh_surface_elements(
    tmp_path: Path, order: int, incomplete: bool, cell: str
) -> None:
    write_solid(tmp_path / "solid.msh", order, incomplete)
    surface = fedic.read_mesh(tmp_path / "solid.msh#TOP")
    write_solid(tmp_path / "bare.msh", order, incomplete, groups=False)
    faces = fedic.read_mesh(tmp_path / "bare.msh#z-max")
    assert list(faces.cells) == [cell]
    assert faces.areas().sum() == pytest.approx(6.0)

    def places(mesh: fedic.Mesh) -> set[frozenset[tuple[float, ...]]]:
        return {frozenset(map(tuple, mesh.points[nodes].round(9).tolist())) for nodes in mesh.cells[cell]}

    assert places(faces) == places(surface)


@pytest.mark.parametrize(
    ("name", "points", "area"),
    [
        ("tetra", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], 1.5 + np.sqrt(3.0) / 2),
        ("pyramid", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)], 2.0 + np.sqrt(2.0)),
        ("wedge", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)], 3.0 + np.sqrt(2.0)),
    ],
)
def test_faces_of_second_order_have_the_middles_of_the_edges(
    name: str, points: list[tuple[float, float, float]], area: float
) -> None:
    edges = {
        "tetra": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
        "pyramid": [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)],
        "wedge": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    }[name]
    corners = np.array(points, dtype=float)
    nodes = np.concatenate([corners, [corners[list(edge)].mean(axis=0) for edge in edges]])
    for count, cells in ((len(corners), {"triangle", "quad"}), (len(nodes), {"triangle6", "quad8"})):
        kind = name if count == len(corners) else f"{name}{count}"
        faces = boundary_faces([(kind, np.arange(count)[np.newaxis])])
        assert set(faces) <= cells
        mesh = fedic.Mesh(nodes[:count], faces)
        assert mesh.areas().sum() == pytest.approx(area)
        outwards = mesh.points - mesh.points.mean(axis=0)
        for each in faces.values():
            a, b, c = (mesh.points[each[:, k]] for k in range(3))
            assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), outwards[each[:, 0]]) > 0).all()


def test_faces_between_solids_are_not_on_the_boundary() -> None:
    cubes = np.array([[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]])
    assert len(boundary_faces([("hexahedron", cubes)])["quad"]) == 10
    # The second cube is collapsed to a wedge: the collapsed face is left out, two faces are triangles.
    cubes[1, [2, 6]] = cubes[1, [1, 5]]
    faces = boundary_faces([("hexahedron", cubes)])["quad"]
    assert len(faces) == 9
    assert sum(len(set(nodes)) == 3 for nodes in faces.tolist()) == 2


def test_named_surfaces_that_are_cells_of_the_mesh_keep_its_sets() -> None:
    rows = [np.arange(3)]
    surfaces = {"cells": [("quad", QUADS[[1, 0]][:, [1, 2, 3, 0]])], "faces": [("quad", np.array([[0, 1, 9, 8]]))]}
    contents = MeshFile(POINTS, [("quad", QUADS)], cell_sets={"lower": rows}, surfaces=surfaces)
    part = chosen(Path("a.inp"), contents, "CELLS")
    np.testing.assert_array_equal(part.surface_cells()["quad"], QUADS[:2])
    assert part.sets()["lower"].cells.tolist() == [0, 1]
    part = chosen(Path("a.inp"), contents, "faces")
    np.testing.assert_array_equal(part.surface_cells()["quad"], [[0, 1, 9, 8]])
    assert part.sets() == {}


def test_a_file_that_is_not_one_mesh_is_read_only_by_parts() -> None:
    surfaces = {"PLATE-1": [("quad", QUADS)]}
    contents = MeshFile(POINTS, [], surfaces=surfaces, needs_selection="a.inp: choose PLATE-1.")
    with pytest.raises(fedic.MeshError, match="choose PLATE-1"):
        check_whole(Path("a.inp"), contents)
    assert len(chosen(Path("a.inp"), contents, "plate-1").surface_cells()["quad"]) == 6
