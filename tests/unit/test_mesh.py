"""Cell types, sets and transformations of meshes."""

import pickle

import numpy as np
import pytest

import fedic
from fedic import CELL_TYPES, MeshSet

BOUNDS = (0.5, -1.0, 6.5, 3.0)


def plate(cell: str = "quad") -> fedic.Mesh:
    sets = {"start": MeshSet(nodes=[2, 0, 1, 1]), "last cells": MeshSet(cells=[5, 4])}
    return fedic.rectangle_mesh(BOUNDS, 2.0, cell).with_sets(sets)


def space(points: np.ndarray) -> np.ndarray:
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


def same_sets(first: fedic.Mesh, second: fedic.Mesh) -> bool:
    return bool(first.sets) and first.sets == second.sets


@pytest.mark.parametrize("cell", CELL_TYPES)
def test_data_of_a_cell_type_agree(cell: str) -> None:
    data = CELL_TYPES[cell]
    assert data.name == cell
    assert data.reference_nodes.shape == (data.num_nodes, 2)
    assert data.num_corners == (3 if data.is_triangle else 4)
    assert len(data.outline) == data.num_corners * data.edge_intervals
    assert len(set(data.outline)) == len(data.outline)
    assert max(data.outline) < data.num_nodes
    assert sum(data.centre_weights) == pytest.approx(1.0)
    centre = np.array(data.centre_weights) @ data.reference_nodes
    np.testing.assert_allclose(centre, np.full(2, 1 / 3) if data.is_triangle else np.zeros(2), atol=1e-15)


def test_codes_of_cell_types_are_unique_and_the_table_is_read_only() -> None:
    assert len({each.vtk_type for each in CELL_TYPES.values()}) == len(CELL_TYPES)
    suffixes = [suffix for each in CELL_TYPES.values() for suffix in each.abaqus_suffixes]
    assert len(set(suffixes)) == len(suffixes)
    with pytest.raises(TypeError):
        CELL_TYPES["line"] = CELL_TYPES["quad"]  # type: ignore[index]


@pytest.mark.parametrize("cell", CELL_TYPES)
def test_areas_and_strains_of_a_linear_field_are_exact(cell: str) -> None:
    mesh = plate(cell)
    assert mesh.areas().sum() == pytest.approx(24.0, rel=1e-14)
    gradient = np.array([[0.01, 0.03], [-0.02, 0.05]])
    strains = mesh.strains(mesh.points @ gradient.T, "small")
    np.testing.assert_allclose(strains, np.tile([0.01, 0.05, 0.005], (mesh.num_cells, 1)), atol=1e-15)


@pytest.mark.parametrize("cell", CELL_TYPES)
def test_areas_and_strains_do_not_change_with_a_rigid_motion_in_space(cell: str) -> None:
    mesh = plate(cell)
    rotation, shift = [0.7, -0.4, 0.2], [3.0, -5.0, 8.0]
    displacement = np.column_stack([0.01 * mesh.points, np.zeros(mesh.num_nodes)])
    moved = mesh.rotated(rotation).translated(shift)
    cross, angle = np.cross(np.eye(3), rotation), np.linalg.norm(rotation)
    matrix = np.eye(3) + np.sin(angle) / angle * cross + (1 - np.cos(angle)) / angle**2 * cross @ cross
    np.testing.assert_allclose(moved.points, space(mesh.points) @ matrix.T + shift, atol=1e-13)
    np.testing.assert_allclose(moved.areas(), mesh.areas(), rtol=1e-13)
    # An equibiaxial strain is the same along any axes.
    np.testing.assert_allclose(
        moved.strains(displacement @ matrix.T, "small"), np.tile([0.01, 0.01, 0.0], (mesh.num_cells, 1)), atol=1e-15
    )


def test_a_displacement_of_two_components_lies_in_the_plane() -> None:
    mesh = plate().rotated([0.3, 0.5, 0.0])
    displacement = 0.01 * mesh.points[:, :2] @ np.array([[1.0, 2.0], [3.0, 4.0]])
    padded = np.column_stack([displacement, np.zeros(mesh.num_nodes)])
    np.testing.assert_array_equal(mesh.strains(displacement), mesh.strains(padded))
    with pytest.raises(fedic.OptionError, match=r"displacement must have shape \(n, 2\)"):
        mesh.strains(np.zeros((mesh.num_nodes, 4)))
    with pytest.raises(fedic.OptionError, match="one row per node"):
        mesh.strains(padded[1:])


def test_scaling_and_translation_keep_the_plane_and_the_sets() -> None:
    mesh = plate()
    scaled = mesh.scaled(1e-3)
    np.testing.assert_array_equal(scaled.points, mesh.points * 1e-3)
    assert same_sets(scaled, mesh)
    moved = mesh.translated((1.5, -2.0))
    np.testing.assert_array_equal(moved.points, mesh.points + np.array([1.5, -2.0]))
    assert same_sets(moved, mesh)
    raised = mesh.translated((0.0, 0.0, 4.0))
    np.testing.assert_array_equal(raised.points, np.column_stack([mesh.points, np.full(mesh.num_nodes, 4.0)]))
    assert same_sets(raised, mesh)
    for factor in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(fedic.OptionError, match="positive finite factor"):
            mesh.scaled(factor)
    with pytest.raises(fedic.OptionError, match=r"vector must have shape \(2,\) or \(3,\)"):
        mesh.translated([1.0])


def test_rotation_in_the_plane_about_a_point() -> None:
    mesh = plate()
    centre = np.array([2.0, 1.0])
    turned = mesh.rotated([0.0, 0.0, np.pi / 2], centre)
    assert turned.points.shape[1] == 2
    x, y = (mesh.points - centre).T
    np.testing.assert_allclose(turned.points, np.column_stack([-y, x]) + centre, atol=1e-14)
    by_matrix = mesh.rotated([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], centre)
    np.testing.assert_allclose(by_matrix.points, turned.points, atol=1e-14)
    assert same_sets(turned, mesh)
    assert turned.flipped_cells.size == 0


def test_turning_a_mesh_over_reverses_its_cells() -> None:
    mesh = plate("triangle")
    over = mesh.rotated([np.pi, 0.0, 0.0])
    np.testing.assert_array_equal(over.flipped_cells, np.arange(mesh.num_cells))
    assert over.rotated([np.pi, 0.0, 0.0]).flipped_cells.size == 0
    np.testing.assert_allclose(over.areas(), mesh.areas())


def test_matrices_that_are_not_rotations_are_refused() -> None:
    mesh = plate()
    for matrix in (np.diag([1.0, 1.0, -1.0]), 2.0 * np.eye(3), np.full((3, 3), np.nan)):
        with pytest.raises(fedic.OptionError, match="orthonormal with determinant 1"):
            mesh.rotated(matrix)
    with pytest.raises(fedic.OptionError, match="rotation vector"):
        mesh.rotated(np.zeros((2, 3)))
    with pytest.raises(fedic.OptionError, match="rotation must"):
        mesh.rotated([1.0, 2.0])


def test_sets_hold_sorted_nodes_and_cells() -> None:
    mesh = plate()
    assert mesh.sets["start"].nodes.tolist() == [0, 1, 2]
    assert mesh.sets["start"].cells.tolist() == []
    last = mesh.sets["last cells"]
    assert last.cells.tolist() == [4, 5]
    np.testing.assert_array_equal(last.nodes, np.unique(mesh.cells["quad"][[4, 5]]))
    assert repr(last) == "MeshSet(6 nodes, 2 cells)"
    assert mesh.with_sets({}).sets == {}


@pytest.mark.parametrize(
    ("sets", "message"),
    [
        ({"a": MeshSet(nodes=[99])}, 'set "a" refers to node 99, but the mesh has 12 nodes'),
        ({"a": MeshSet(cells=[6])}, 'set "a" refers to cell 6, but the mesh has 6 cells'),
        ({"a": [1, 2]}, "MeshSet"),
        ([1], "sets must be a mapping"),
    ],
)
def test_sets_outside_the_mesh_are_refused(sets: object, message: str) -> None:
    mesh = fedic.rectangle_mesh(BOUNDS, 2.0)
    with pytest.raises(fedic.MeshError, match=message):
        fedic.Mesh(mesh.points, mesh.cells, sets)  # type: ignore[arg-type]
    with pytest.raises(fedic.MeshError, match=message):
        mesh.with_sets(sets)  # type: ignore[arg-type]


@pytest.mark.parametrize("indices", [[-1], [0.5], [[1, 2]], "nodes"])
def test_sets_of_anything_but_indices_are_refused(indices: object) -> None:
    with pytest.raises(fedic.OptionError, match="nodes of a set"):
        MeshSet(nodes=indices)  # type: ignore[arg-type]


def test_pickling_keeps_the_sets() -> None:
    mesh = plate("quad9").rotated([0.1, 0.2, 0.3])
    copy = pickle.loads(pickle.dumps(mesh))
    np.testing.assert_array_equal(copy.points, mesh.points)
    assert same_sets(copy, mesh)


def test_the_size_of_a_rectangle_mesh_has_no_default() -> None:
    with pytest.raises(TypeError, match="size"):
        fedic.rectangle_mesh((0.0, 0.0, 0.1, 0.1))  # type: ignore[call-arg]
