"""Gauges: their means on known fields, and what is refused."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import fedic
from fedic.probes import table
from fedic.probes.polygons import polygon_area, polygon_pieces
from scenes.fields import Fields, result_of

MESH = fedic.rectangle_mesh((0, 0, 100, 80), 10, "quad8")
L_SHAPE = [(10, 10), (90, 10), (90, 30), (43, 37), (30, 70), (10, 70)]
GRADIENT = np.array([[0.02, 0.01], [-0.03, 0.04]])


def linear(mesh: fedic.Mesh) -> NDArray[np.float64]:
    return np.asarray(mesh.points @ GRADIENT.T + (0.3, -0.2))


def read(displacement: NDArray[np.float64], fields: Any, at: Any, mesh: fedic.Mesh = MESH, **options: Any) -> Any:
    damaged = options.pop("damaged", ())
    return table(Fields(mesh, [result_of(mesh, displacement, damaged=damaged)]), fields, at, **options).loc[0]


def centroid(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the centre of area by triangles about the first corner."""
    first = corners[0]
    pairs = zip(corners[1:-1] - first, corners[2:] - first, strict=True)
    parts = [(0.5 * (a[0] * b[1] - a[1] * b[0]), (a + b) / 3) for a, b in pairs]
    area = sum(part for part, _ in parts)
    return np.asarray(first + sum(part * centre for part, centre in parts) / area)


corners = st.lists(st.tuples(st.floats(0.2, 1.0), st.floats(0.1, 1.0)), min_size=3, max_size=12)


@settings(max_examples=40, deadline=None)
@given(corners=corners, step=st.floats(0.3, 20.0))
def test_the_mean_of_a_linear_field_over_a_polygon_is_exact(corners: list[tuple[float, float]], step: float) -> None:
    """Star-shaped polygons about (50, 40), convex or not."""
    radius, share = np.array(corners).T
    angle = 2 * np.pi * np.cumsum(share) / share.sum()
    outline = np.column_stack([50 + 45 * radius * np.cos(angle), 40 + 35 * radius * np.sin(angle)])
    points, areas = polygon_pieces(outline, step)
    assert areas.sum() == pytest.approx(polygon_area(outline), rel=1e-9)
    np.testing.assert_allclose(areas @ points / areas.sum(), centroid(outline), rtol=1e-9)


@pytest.mark.parametrize("cell", ["quad", "triangle", "quad8", "triangle6", "quad9"])
@pytest.mark.parametrize("outline", [L_SHAPE, [(12.3, 7.1), (93.2, 22.0), (41.0, 77.7)]])
def test_gauges_read_the_mean_of_a_linear_displacement(cell: str, outline: Any) -> None:
    mesh = fedic.rectangle_mesh((0, 0, 100, 80), 10, cell)  # type: ignore[arg-type]
    row = read(linear(mesh), ["x", "y", "exx", "eyy", "exy"], fedic.Gauge.polygon(outline), mesh, measure="small")
    expected = GRADIENT @ centroid(np.array(outline, dtype=float)) + (0.3, -0.2)
    np.testing.assert_allclose([row["x"], row["y"]], expected, rtol=1e-9)
    np.testing.assert_allclose([row["exx"], row["eyy"], row["exy"]], [0.02, 0.04, -0.01], rtol=1e-9)


def test_the_mean_of_a_curved_strain_converges() -> None:
    mesh = fedic.rectangle_mesh((0, 0, 100, 80), 5, "quad8")
    x = mesh.points[:, 0]
    row = read(np.column_stack([1e-4 * x**3 / 3, 0 * x]), "exx", fedic.Gauge.rectangle(20, 10, 71, 60), mesh)
    exact = 1e-4 * (71**3 - 20**3) / 3 / 51 + 0.5e-8 * (71**5 - 20**5) / 5 / 51
    assert row["exx"] == pytest.approx(exact, rel=2e-3)


def test_a_gauge_over_the_whole_mesh_and_one_within_a_cell_are_read() -> None:
    gauges = [fedic.Gauge.rectangle(100, 80, 0, 0, name="all"), fedic.Gauge.rectangle(13, 13, 13.5, 14, name="small")]
    row = read(linear(MESH), ["x", "eyy"], gauges, measure="small")
    np.testing.assert_allclose([row["eyy_all"], row["eyy_small"]], 0.04, rtol=1e-9)
    assert row["x_all"] == pytest.approx(0.02 * 50 + 0.01 * 40 + 0.3)
    assert row["x_small"] == pytest.approx(0.02 * 13.25 + 0.01 * 13.5 + 0.3)


def test_a_line_reads_the_mean_along_it() -> None:
    row = read(linear(MESH), ["x", "eyy"], fedic.Gauge.line((10, 20), (90, 60)), measure="small")
    assert row["x"] == pytest.approx(0.02 * 50 + 0.01 * 40 + 0.3)
    assert row["eyy"] == pytest.approx(0.04)


def test_an_extensometer_reads_elongation_strain_and_rotation() -> None:
    angle, stretch = 0.7, 1.05
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = stretch * MESH.points @ turn.T + (3.0, 4.0) - MESH.points
    row = read(moved, ["strain", "elongation", "rotation"], fedic.Gauge.extensometer((20, 10), (50, 50)))
    assert row["strain"] == pytest.approx(0.05)
    assert row["elongation"] == pytest.approx(0.05 * 50)
    assert row["rotation"] == pytest.approx(angle)


def test_the_mean_is_that_of_the_measured_part_and_nan_below_half() -> None:
    mesh = fedic.rectangle_mesh((0, 0, 40, 10), 10, "quad")
    gauge = fedic.Gauge.rectangle(0, 0, 40, 10)
    x = mesh.points[:, 0]
    stretched = np.column_stack([1e-4 * x**2 / 2, 0 * x])
    fields = ["exx", "measured_share"]
    whole, half, less = (read(stretched, fields, gauge, mesh, damaged=range(n), measure="small") for n in (0, 2, 3))
    assert whole["exx"] == pytest.approx(1e-4 * 20)
    assert half["exx"] == pytest.approx(1e-4 * 30)
    assert np.isnan(less["exx"])
    assert [row["measured_share"] for row in (whole, half, less)] == pytest.approx([1.0, 0.5, 0.25])


@pytest.mark.parametrize(
    ("gauge", "message"),
    [
        (fedic.Gauge.rectangle(50, 40, 101, 60, name="wide"), r"gauge 'wide' has the point \(101, 40\) outside"),
        (fedic.Gauge.line((5, 5), (5, 90), name="long"), r"gauge 'long' has the point \(5, 90\) outside the mesh"),
        (fedic.Gauge.extensometer((-1, 5), (5, 9)), r"gauge \(extensometer\) has the point \(-1, 5\) outside"),
        ([(5.0, 5.0), (150.0, 5.0)], r"point 1, \(150, 5\), lies outside the mesh; it reaches from \(0, 0\)"),
    ],
)
def test_places_outside_the_mesh_are_refused_before_any_result_is_read(gauge: Any, message: str) -> None:
    series = Fields(MESH, [result_of(MESH, linear(MESH))])
    fields = "strain" if isinstance(gauge, fedic.Gauge) and gauge.kind == "extensometer" else "eyy"
    with pytest.raises(fedic.OptionError, match=message):
        table(series, fields, gauge)
    assert series.read == []


def test_a_gauge_across_a_hole_is_refused() -> None:
    full = fedic.rectangle_mesh((0, 0, 100, 80), 10, "quad")
    mesh = fedic.Mesh(full.points, {"quad": np.delete(full.cells["quad"], [34, 35, 44, 45], axis=0)})
    with pytest.raises(fedic.OptionError, match="11% of gauge 'x' lie outside the mesh, in a hole or beyond"):
        read(linear(mesh), "eyy", fedic.Gauge.rectangle(20, 10, 80, 70, name="x"), mesh)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fedic.Gauge.polygon([(0, 0), (1, 1)]), "has 2 corners; give three or more"),
        (lambda: fedic.Gauge.polygon([(0, 0), (9, 9), (9, 0), (0, 9)]), "begin at corners 0 and 2 cross"),
        (lambda: fedic.Gauge.polygon([(0, 0), (1, 1), (2, 2)]), "enclose no area"),
        (lambda: fedic.Gauge.polygon([(0, 0), (1, np.nan), (2, 2)]), "not finite"),
        (lambda: fedic.Gauge.polygon("nonsense"), "must be numbers"),
        (lambda: fedic.Gauge.rectangle(3, 0, 3, 5, name="flat"), "gauge 'flat' enclose no area"),
        (lambda: fedic.Gauge.line((1, 2), (1, 2)), "start and end of a gauge coincide"),
        (lambda: fedic.Gauge.extensometer((1, 2), (1, 2, 3)), r"b of a gauge has shape \(1, 3\)"),
        (lambda: fedic.Gauge.extensometer((1, 2), [(1, 3), (1, 4)]), "give one point"),
        (lambda: fedic.Gauge.line((1, 2), (1, 3), name=3), "the name of a gauge is a text"),  # type: ignore[arg-type]
    ],
)
def test_malformed_gauges_are_refused(make: Any, message: str) -> None:
    with pytest.raises(fedic.OptionError, match=message):
        make()
