"""Boundary features of a mesh: their pieces, kinds and names."""

from pathlib import Path

import numpy as np
import pytest

import fedic
from fedic.registration._sampling import sample_feature
from scenes.plate import CENTRE, LENGTH, RADIUS, WIDTH, plate_mesh

UNIT = fedic.FrontParallel(10.0)


def by_name(mesh: fedic.Mesh) -> dict[str, fedic.registration.BoundaryFeature]:
    return {feature.name: feature for feature in fedic.boundary_features(mesh)}


def ring(radius: float, count: int, quadratic: bool) -> fedic.Mesh:
    """Return a disc with a hole, of two rings of cells."""
    angles = 2.0 * np.pi * np.arange(2 * count) / (2 * count)
    radii = np.array([radius, 1.5 * radius, 2.0 * radius])
    points = (radii[:, None, None] * np.column_stack([np.cos(angles), np.sin(angles)])).reshape(-1, 2)
    k = 2 * np.arange(count)
    following = (k + 2) % (2 * count)
    row = 2 * count
    if quadratic:
        cell = [k, k + 2 * row, following + 2 * row, following, k + row, k + 1 + 2 * row, following + row, k + 1]
        return fedic.Mesh(points, {"quad8": np.column_stack(cell)})
    return fedic.Mesh(points, {"quad": np.column_stack([k, k + 2 * row, following + 2 * row, following])})


@pytest.mark.parametrize("cell", ["quad", "triangle", "quad8", "quad9", "triangle6"])
def test_a_rectangle_has_four_sides(cell: str) -> None:
    mesh = fedic.rectangle_mesh((1.0, 2.0, 7.0, 5.0), 1.0, cell)  # type: ignore[arg-type]
    found = by_name(mesh)
    assert list(found) == ["left", "right", "bottom", "top", "outline"]
    assert [found[name].kind for name in found] == ["side"] * 4 + ["loop"]
    points = mesh.points
    for name, axis, value in (("left", 0, 1.0), ("right", 0, 7.0), ("bottom", 1, 2.0), ("top", 1, 5.0)):
        np.testing.assert_array_equal(points[found[name].nodes, axis], value)
        assert found[name].length == pytest.approx(3.0 if axis == 0 else 6.0)
    assert found["outline"].length == pytest.approx(18.0)
    assert "straight, (1, 2) to (7, 2)" in repr(found["bottom"])


@pytest.mark.parametrize("cell", ["quad", "triangle"])
def test_a_plate_with_a_hole(cell: str) -> None:
    found = by_name(plate_mesh(cell))
    assert list(found) == ["left", "right", "bottom", "top", "outline", "hole 0"]
    circle = found["hole 0"].pieces[0].circle
    assert circle is not None
    assert found["hole 0"].kind == "circle"
    np.testing.assert_allclose([*circle.centre, circle.radius], [*CENTRE, RADIUS], rtol=1e-12)


def test_samples_lie_on_the_circle_and_normals_point_outwards() -> None:
    mesh = plate_mesh(divisions=4)  # chords 0.1 mm inside the circle
    for name, feature in by_name(mesh).items():
        if name == "outline":
            continue
        samples = sample_feature(mesh, feature, UNIT, 12.0)
        inwards = samples.points - 0.3 * samples.normals
        x, y = inwards.T[:2]
        inside = (x > 0) & (x < LENGTH) & (y > 0) & (y < WIDTH) & (np.hypot(x - CENTRE[0], y - CENTRE[1]) > RADIUS)
        assert inside.all(), name
        if name == "hole 0":
            np.testing.assert_allclose(np.linalg.norm(samples.points[:, :2] - CENTRE, axis=1), RADIUS, rtol=1e-12)
        assert np.bincount(samples.blocks).min() >= 8


@pytest.mark.parametrize("quadratic", [False, True])
def test_outline_and_hole_of_a_ring_are_circles(quadratic: bool) -> None:
    mesh = ring(10.0, 16, quadratic)
    found = by_name(mesh)
    assert {name: feature.kind for name, feature in found.items()} == {"outline": "circle", "hole 0": "circle"}
    circles = [feature.pieces[0].circle for feature in found.values()]
    np.testing.assert_allclose([circle.radius for circle in circles if circle], [20.0, 10.0], rtol=1e-9)


def test_samples_of_quadratic_cells_lie_on_the_curved_edges() -> None:
    mesh = ring(10.0, 24, quadratic=True)
    stretched = fedic.Mesh(mesh.points * [2.0, 1.0], mesh.cells)
    hole = by_name(stretched)["hole 0"]
    assert hole.kind == "loop"
    x, y = sample_feature(stretched, hole, UNIT, 12.0).points.T[:2]
    off = np.abs(np.hypot(x / 2.0, y) - 10.0)
    assert off.max() < 0.02  # chords are 0.09 inside
    assert by_name(ring(10.0, 24, quadratic=False))["hole 0"].kind == "circle"


def test_straight_pieces_of_a_hole_and_a_notch_are_named_by_their_side() -> None:
    grid = fedic.rectangle_mesh((0.0, 0.0, 9.0, 6.0), 1.0)
    cells = grid.cells["quad"]
    x, y = grid.points[cells].mean(axis=1).T
    hole = (x > 2) & (x < 4) & (y > 2) & (y < 4)
    notch = (x > 6) & (x < 7) & (y > 5)
    mesh = fedic.Mesh(grid.points, {"quad": cells[~(hole | notch)]})
    found = by_name(mesh)
    outer = ["left 0", "left 1", "right 0", "right 1", "bottom", "top 0", "top 1", "top 2", "outline"]
    inner = [f"hole 0 {side}" for side in ("left", "right", "bottom", "top")]
    assert list(found) == [*sorted(outer[:2]), *outer[2:], *inner, "hole 0"]
    assert set(mesh.points[found["hole 0 left"].nodes, 0]) == {2.0}
    assert set(mesh.points[found["top 1"].nodes, 1]) == {5.0}


def test_the_outline_of_a_dog_bone_is_split_into_lines_and_arcs(gmsh: object) -> None:
    angle = np.linspace(0.0, np.pi / 2.0, 25)
    fillet = np.column_stack([30.0 + 10.0 * np.sin(angle), 15.0 - 10.0 * np.cos(angle)])  # (30, 5) to (40, 15)
    quarter = np.concatenate([fillet, [[60.0, 15.0]]])
    right = np.concatenate([quarter, (quarter * [1.0, -1.0])[::-1]])
    outline = np.concatenate([right, (right * [-1.0, 1.0])[::-1]])[::-1]
    mesh = fedic.unstructured_mesh(outline, size=3.0)
    found = by_name(mesh)
    assert sorted(name for name in found if name.startswith("arc")) == ["arc 0", "arc 1", "arc 2", "arc 3"]
    for name in ("arc 0", "arc 1", "arc 2", "arc 3"):
        circle = found[name].pieces[0].circle
        assert circle is not None
        assert circle.radius == pytest.approx(10.0, rel=2e-2)
    gauge = [feature for name, feature in found.items() if name.startswith(("top", "bottom"))]
    np.testing.assert_allclose(sorted(feature.length for feature in gauge)[-2:], 60.0, atol=1.5)


def test_feature_names_do_not_depend_on_the_numbering(shared_data: object) -> None:
    mesh = plate_mesh()
    rng = np.random.default_rng(0)
    order = rng.permutation(len(mesh.points))
    back = np.argsort(order)
    shuffled = fedic.Mesh(mesh.points[order], {"quad": back[rng.permutation(mesh.cells["quad"])]})
    for name, feature in by_name(mesh).items():
        other = by_name(shuffled)[name]
        assert set(order[other.nodes]) == set(feature.nodes)


def test_the_open_hole_has_its_hole_and_four_sides(shared_data: object) -> None:
    path: Path = shared_data("openhole/abaqus_q4_m.inp")  # type: ignore[operator]
    found = by_name(fedic.read_mesh(path))
    assert list(found) == ["left", "right", "bottom", "top", "outline", "hole 0"]
    assert found["hole 0"].kind == "circle"
