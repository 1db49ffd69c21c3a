"""Meshes with repeated nodes, seams and strongly distorted cells: measured right, or named in a warning."""

import warnings
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import fedic

Pair = tuple[NDArray[np.uint8], NDArray[np.uint8]]
SHIFT = np.array([1.3, -0.6])
"""Displacement of `speckle_pair`."""
WHOLE = fedic.rectangle_mesh((20, 20, 180, 140), size=20)
SHAPE = (160, 200)


def own_nodes(mesh: fedic.Mesh) -> fedic.Mesh:
    """Return the mesh with nodes of its own in each cell, as the files of some programs hold it."""
    (name, cells), *_ = mesh.cells.items()
    return fedic.Mesh(mesh.points[cells.ravel()], {name: np.arange(cells.size).reshape(cells.shape)})


def with_seam(mesh: fedic.Mesh, x: float) -> fedic.Mesh:
    """Return the mesh in two parts that share no nodes, side by side along a line of constant x."""
    cells = mesh.cells["quad"].copy()
    seam = np.flatnonzero(np.isclose(mesh.points[:, 0], x))
    right = mesh.points[cells].mean(axis=1)[:, 0] > x
    twin = np.arange(mesh.num_nodes)
    twin[seam] = mesh.num_nodes + np.arange(seam.size)
    cells[right] = twin[cells[right]]
    return fedic.Mesh(np.concatenate([mesh.points, mesh.points[seam]]), {"quad": cells})


def messages(call: Callable[[], object]) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call()
    assert all(issubclass(each.category, fedic.QualityWarning) for each in caught)
    return [str(each.message) for each in caught]


def test_a_quad_with_a_repeated_node_measures_as_a_triangle(speckle_pair: Pair) -> None:
    points = 60.0 * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1.0]]) + (30, 40)
    cells = {"quad": [[0, 1, 2, 3], [1, 4, 5, 5]]}
    collapsed = fedic.Mesh(points, cells)
    np.testing.assert_array_equal(collapsed.cells["quad"], cells["quad"])
    split = fedic.Mesh(points, {"quad": cells["quad"][:1], "triangle": [[1, 4, 5]]})
    found, expected = (fedic.correlate(*speckle_pair, mesh, tolerance=1e-6) for mesh in (collapsed, split))
    assert found.converged
    np.testing.assert_allclose(found.displacement, np.broadcast_to(SHIFT, (6, 2)), atol=5e-3)
    np.testing.assert_array_equal(found.displacement, expected.displacement)
    np.testing.assert_array_equal(found.cell_residuals, expected.cell_residuals)
    np.testing.assert_allclose(found.strains("small"), expected.strains("small"), atol=1e-12)


def test_a_collapsed_quad_among_others_keeps_the_numbers_of_the_cells(speckle_pair: Pair) -> None:
    points = 60.0 * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1.0]]) + (30, 40)
    mesh = fedic.Mesh(points, {"quad": [[1, 4, 5, 5], [0, 1, 2, 3]]})
    result = fedic.correlate(*speckle_pair, mesh, tolerance=1e-6)
    other = fedic.correlate(*speckle_pair, fedic.Mesh(points, {"quad": [[0, 1, 2, 3], [1, 4, 5, 5]]}), tolerance=1e-6)
    np.testing.assert_allclose(result.cell_residuals, other.cell_residuals[::-1], rtol=1e-6)


def test_a_collapsed_quad8_measures_as_a_quadratic_triangle(speckle_pair: Pair) -> None:
    corners = np.array([[40.0, 30.0], [150.0, 40.0], [80.0, 130.0]])
    points = np.concatenate([corners, (corners + np.roll(corners, -1, axis=0)) / 2])
    collapsed = fedic.Mesh(points, {"quad8": [[0, 1, 2, 2, 3, 4, 2, 5]]})
    triangle = fedic.Mesh(points, {"triangle6": [[0, 1, 2, 3, 4, 5]]})
    found, expected = (fedic.correlate(*speckle_pair, mesh) for mesh in (collapsed, triangle))
    np.testing.assert_array_equal(found.displacement, expected.displacement)


def test_cells_that_share_no_nodes_are_named_in_a_warning(speckle_pair: Pair) -> None:
    mesh = own_nodes(WHOLE)
    text = (
        f"no two cells share a node, so that each cell is measured alone: the {mesh.num_nodes} nodes are at 63 places"
    )
    with pytest.warns(fedic.QualityWarning, match=text) as caught:
        fedic.correlate(*speckle_pair, mesh)
    assert caught[0].filename == __file__
    assert "mesh.merge_nodes(" in str(caught[0].message)


def test_joining_the_nodes_measures_as_the_whole_mesh(speckle_pair: Pair) -> None:
    joined = own_nodes(WHOLE).merge_nodes(1e-6)
    places = np.lexsort(joined.points.T), np.lexsort(WHOLE.points.T)
    found, expected = (fedic.correlate(*speckle_pair, mesh).displacement for mesh in (joined, WHOLE))
    np.testing.assert_allclose(found[places[0]], expected[places[1]], atol=1e-9)


def test_a_seam_is_named_with_its_nodes_and_place() -> None:
    mesh = with_seam(WHOLE, 100.0)
    [text] = messages(lambda: fedic.Correlator(texture(), mesh))
    assert text.startswith("7 pairs of nodes are at one place along x = 100 (nodes 4 and 63, 13 and 64, ")
    assert text.endswith("the displacement may jump there; unless that is a crack, mesh.merge_nodes(0) joins them")
    assert mesh.merge_nodes(0.0).num_nodes == WHOLE.num_nodes
    assert not messages(lambda: fedic.Correlator(texture(), mesh.merge_nodes(0.0)))


def test_a_seam_across_the_image_is_described_by_its_ends() -> None:
    turned = with_seam(WHOLE, 100.0).translated((-100, -80)).rotated([0, 0, 0.3]).scaled(0.7).translated((100, 80))
    [text] = messages(lambda: fedic.Correlator(texture(), turned))
    assert text.startswith("7 pairs of nodes are at one place between (")


def test_nodes_of_a_seam_that_do_not_match_are_named() -> None:
    left = fedic.rectangle_mesh((20, 20, 100, 140), size=20)
    right = fedic.rectangle_mesh((100, 20, 180, 140), size=30, cell="triangle")
    mesh = fedic.Mesh(
        np.concatenate([left.points, right.points]),
        {"quad": left.cells["quad"], "triangle": right.cells["triangle"] + left.num_nodes},
    )
    [matching, hanging] = messages(lambda: fedic.Correlator(texture(), mesh))
    assert matching.startswith("3 pairs of nodes are at one place along x = 100 (")
    assert hanging.startswith("6 nodes lie on the edge of a cell without being its node along x = 100 (nodes 9, 14, ")
    np.testing.assert_allclose(mesh.points[mesh.hanging_nodes(), 1], [40, 60, 100, 120, 50, 110])


def test_the_remedy_of_the_warning_removes_the_seam() -> None:
    mesh = with_seam(WHOLE, 100.0)
    moves = np.random.default_rng(0).uniform(-3e-4, 3e-4, mesh.points.shape)
    shaken = fedic.Mesh(mesh.points + moves, mesh.cells)
    [text] = messages(lambda: fedic.Correlator(texture(), shaken))
    tolerance = float(text.split("merge_nodes(")[1].split(")")[0])
    assert not len(shaken.merge_nodes(tolerance).coincident_nodes())


def test_strongly_distorted_cells_are_named() -> None:
    points = np.array([[30, 20], [110, 20], [71, 100], [69, 100], [190, 20], [190, 100.0]])
    mesh = fedic.Mesh(points, {"quad": [[0, 1, 2, 3], [1, 4, 5, 2]]})
    [text] = messages(lambda: fedic.Correlator(texture(), mesh))
    assert text.startswith("cell 0 is strongly distorted: the area element at one node is less than 1/30 of that")
    np.testing.assert_array_equal(mesh.distorted_cells(), [0])


@pytest.mark.parametrize("cell", fedic.CELL_TYPES)
def test_a_sound_mesh_gives_no_warning(cell: str) -> None:
    mesh = fedic.rectangle_mesh((20, 20, 180, 140), size=20, cell=cell)
    assert not messages(lambda: fedic.Correlator(texture(), mesh))
    assert mesh.coincident_nodes().shape == (0, 2)
    assert mesh.distorted_cells().shape == mesh.hanging_nodes().shape == (0,)


def test_bad_tolerances_and_meshes_are_refused() -> None:
    with pytest.raises(fedic.OptionError, match="tolerance must be a finite number from 0 on"):
        WHOLE.merge_nodes(-1.0)
    with pytest.raises(fedic.MeshError, match="which collapses cells 0, 1, 2") as caught:
        WHOLE.merge_nodes(25.0)
    assert caught.value.cells == list(range(WHOLE.num_cells))
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]])
    middles = (corners + np.roll(corners, -1, axis=0)) / 2
    points = np.concatenate([corners, middles, [[0.5, 1.0]]])
    with pytest.raises(fedic.MeshError, match="cell 0 lists a node more than once") as caught:
        fedic.Mesh(points, {"quad9": [[0, 1, 2, 2, 3, 4, 2, 5, 6]]})
    assert caught.value.cells == [0]


@settings(max_examples=30, deadline=None)
@given(cell=st.sampled_from(sorted(fedic.CELL_TYPES)), angle=st.floats(-3.0, 3.0), scale=st.floats(1e-3, 1e3))
def test_joining_separate_cells_keeps_cells_and_area_in_any_position(cell: str, angle: float, scale: float) -> None:
    whole = fedic.rectangle_mesh((0, 0, 4, 3), size=1, cell=cell).rotated([0, 0, angle]).scaled(scale)
    joined = own_nodes(whole).merge_nodes(1e-6 * scale)
    assert joined.num_nodes == whole.num_nodes
    np.testing.assert_allclose(joined.areas(), whole.areas(), rtol=1e-12)
    assert len(own_nodes(whole).coincident_nodes()) == own_nodes(whole).num_nodes - whole.num_nodes


def texture() -> NDArray[np.uint8]:
    image: NDArray[np.uint8] = np.random.default_rng(0).integers(0, 255, SHAPE).astype(np.uint8)
    return image
