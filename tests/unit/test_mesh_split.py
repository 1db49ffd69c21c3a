"""Meshes cut along the edges of their cells."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fedic
from fedic import CELL_TYPES, MeshSet


def plate(cell: str = "quad") -> fedic.Mesh:
    """Return a mesh of 4 by 3 squares of side 1, each one quadrilateral or two triangles."""
    return fedic.rectangle_mesh((0, 0, 4, 3), 1.0, cell)


def centres(mesh: fedic.Mesh) -> np.ndarray:
    (name, cells), *_ = mesh.cells.items()
    return mesh.points[cells[:, : CELL_TYPES[name].num_corners]].mean(axis=1)


def nodes_of(mesh: fedic.Mesh, chosen: np.ndarray) -> set[int]:
    (cells,) = mesh.cells.values()
    return set(cells[chosen].ravel().tolist())


@pytest.mark.parametrize("cell", CELL_TYPES)
def test_a_crack_has_pairs_of_nodes_in_the_order_of_its_line(cell: str) -> None:
    whole = plate(cell)
    mesh = whole.split([(0, 1), (2, 1)])
    left, right = mesh.coincident_nodes().T
    step = 1 / CELL_TYPES[cell].edge_intervals
    np.testing.assert_array_equal(mesh.points[left], [(x, 1) for x in np.arange(0, 2, step)])
    np.testing.assert_array_equal(right, whole.num_nodes + np.arange(len(left)))
    upper = nodes_of(mesh, centres(mesh)[:, 1] > 1)
    assert upper.issuperset(left.tolist())
    assert upper.isdisjoint(right.tolist())


@pytest.mark.parametrize("cell", CELL_TYPES)
def test_both_sides_of_a_cut_have_the_strains_of_their_own_displacement(cell: str) -> None:
    mesh = plate(cell).split([(0, 1), (1, 1), (1, 2), (4, 2)])
    x, y = centres(mesh).T
    upper = y > np.where(x < 1, 1, 2)
    is_upper = np.isin(np.arange(mesh.num_nodes), list(nodes_of(mesh, upper)))
    field = np.where(is_upper[:, None], mesh.points * (0.01, -0.02) + (0.3, 0.4), mesh.points * (-0.03, 0.05))
    expected = np.where(upper[:, None], (0.01, -0.02, 0.0), (-0.03, 0.05, 0.0))
    np.testing.assert_allclose(mesh.strains(field, "small"), expected, atol=1e-14)


@pytest.mark.parametrize("cell", CELL_TYPES)
def test_merging_undoes_a_cut(cell: str) -> None:
    sets = {"border": MeshSet(nodes=[0, 1, 2]), "cells": MeshSet(cells=[0, 4, 5])}
    whole = plate(cell).with_sets(sets)
    mesh = whole.split([(0, 1), (4, 1)]).split([(2, 3), (2, 0)])
    assert mesh.num_cells == whole.num_cells
    np.testing.assert_array_equal(mesh.areas(), whole.areas())
    joined = mesh.merge_nodes(0.0)
    np.testing.assert_array_equal(joined.points, whole.points)
    for name, cells in whole.cells.items():
        np.testing.assert_array_equal(joined.cells[name], cells)
    assert joined.sets == whole.sets


def test_sets_get_the_new_nodes() -> None:
    sets = {"border": MeshSet(nodes=[0, 5, 10, 15]), "lower row": MeshSet(cells=[0, 1, 2, 3])}
    mesh = plate().with_sets(sets).split([(0, 1), (4, 1)])
    np.testing.assert_array_equal(mesh.sets["border"].nodes, [0, 5, 10, 15, 20])
    np.testing.assert_array_equal(mesh.sets["lower row"].nodes, [0, 1, 2, 3, 4, 20, 21, 22, 23, 24])
    np.testing.assert_array_equal(mesh.sets["lower row"].cells, [0, 1, 2, 3])


def test_a_cut_mesh_is_pickled_and_written(tmp_path: Path) -> None:
    mesh = plate("quad8").split([(0, 1), (2, 1)])
    copy = pickle.loads(pickle.dumps(mesh))
    mesh.write(tmp_path / "cut.vtu")
    for other in (copy, fedic.read_mesh(tmp_path / "cut.vtu")):
        np.testing.assert_array_equal(other.cells["quad8"], mesh.cells["quad8"])
        np.testing.assert_array_equal(other.coincident_nodes(), mesh.coincident_nodes())


def test_a_surface_in_space_is_cut_along_three_coordinates() -> None:
    flat = plate("quad9")
    whole = flat.rotated((0.3, 0.5, 0.2))
    ends = [np.flatnonzero((flat.points == end).all(axis=1))[0] for end in ((0, 1), (2, 1))]
    mesh = whole.split(whole.points[ends])
    assert mesh.points.shape == (whole.num_nodes + 4, 3)
    with pytest.raises(fedic.OptionError, match="point 0 of the line"):
        whole.split([(0, 1), (2, 1)])


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(list(CELL_TYPES)), st.lists(st.sampled_from("NESW"), min_size=2, max_size=12), st.data())
def test_any_walk_along_the_grid_is_followed(cell: str, walk: list[str], data: st.DataObject) -> None:
    whole = plate(cell)
    at = np.array([data.draw(st.integers(0, 4)), data.draw(st.integers(0, 3))])
    line = [at]
    for step in walk:
        at = np.clip(at + {"N": (0, 1), "E": (1, 0), "S": (0, -1), "W": (-1, 0)}[step], 0, (4, 3))
        line.append(at)
    try:
        mesh, refusal = whole.split(line), ""
    except fedic.OptionError as error:
        mesh, refusal = whole, str(error)
    assert bool(refusal) == (mesh.num_nodes == whole.num_nodes)
    assert not refusal or "separates no cells" in refusal or "two different points" in refusal
    assert mesh.num_nodes == whole.num_nodes + len(mesh.coincident_nodes())
    np.testing.assert_array_equal(mesh.areas(), whole.areas())
    np.testing.assert_array_equal(mesh.merge_nodes(0.0).cells[cell], whole.cells[cell])


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ([], r"line must be a 2-dimensional array|line must have shape"),
        ([(1, 1)], "at least two different points"),
        ([(1, 1), (1, 1)], "at least two different points"),
        ([(1, 1), (np.nan, 1)], "point 1 of the line has a coordinate that is not finite"),
        ([(0, 1), (2.3, 1)], r"point 1 of the line, \(2.3, 1\), is at no node .* node 7 at \(2, 1\), 0.3 away"),
        ([(0, 1), (1, 1), (3, 2)], r"leaves the edges of the cells at node 6, \(1, 1\), on the way from its point 1"),
        ([(0, 0), (4, 0)], "separates no cells"),
        ([(1, 1), (2, 1)], "separates no cells"),
        ([0, 1], "line must be a 2-dimensional array"),
        ([(0, 1, 0, 0)], r"line must have shape \(n, 2\) or \(n, 3\)"),
        ("x", "line must be a 2-dimensional array"),
    ],
)
def test_a_line_that_cannot_be_followed_is_refused(line: object, message: str) -> None:
    with pytest.raises(fedic.OptionError, match=message) as caught:
        plate().split(line)  # type: ignore[arg-type]
    assert caught.value.option == "line"


def test_a_line_that_ends_in_the_middle_of_an_edge_is_refused() -> None:
    with pytest.raises(
        fedic.OptionError, match=r"ends or turns back at node \d+, \(1.5, 1\), in the middle of an edge"
    ):
        plate("quad8").split([(0, 1), (1.5, 1)])
