"""Tables of a series: fields, places, frames that failed, and standard deviations."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

import fedic
from fedic.probes import frame_table, table
from fedic.probes.cell_points import typical_cell_size
from fedic.probes.quantities import QUANTITIES
from scenes.fields import Fields, result_of

MESH = fedic.rectangle_mesh((0, 0, 100, 80), 10).with_sets(
    {
        "top": fedic.MeshSet(nodes=np.arange(88, 99)),
        "left": fedic.MeshSet(cells=np.arange(0, 80, 10)),
        "outer": fedic.MeshSet(nodes=[0, 10]),
    }
)
GRADIENT = np.array([[0.02, 0.01], [-0.03, 0.04]])
FIELD = MESH.points @ GRADIENT.T + (0.3, -0.2)
SERIES = Fields(MESH, [result_of(MESH, 0 * FIELD), None, result_of(MESH, FIELD)], times=[0.0, 0.5, 1.25])
ALL = ["x", "y", "magnitude", "u", "v", "exx", "eyy", "exy", "e1", "e2", "von_mises", "residual", "correlation"]


def test_a_table_has_a_row_a_frame_and_failed_frames_are_nan() -> None:
    found = table(SERIES, "eyy")
    assert list(found.columns) == ["time", "name", "eyy", "eyy_std"]
    assert found.index.name == "frame"
    assert list(found["time"]) == [0.0, 0.5, 1.25]
    assert list(found["name"]) == ["image_0.tif", "image_1.tif", "image_2.tif"]
    expected = 0.04 + 0.5 * (0.01**2 + 0.04**2)
    np.testing.assert_allclose(found["eyy"], [0.0, np.nan, expected], atol=1e-12)
    assert np.isnan(found["eyy_std"]).all()
    assert found.attrs == {"measure": "green-lagrange", "unit": "mm"}


def test_every_field_agrees_with_the_result_at_points() -> None:
    points = np.array([[13.0, 22.0], [71.0, 44.0]])
    found = table(SERIES, ALL, points, measure="hencky").loc[2]
    result = SERIES.result(2)
    strains, moved = result.strains("hencky", points), result.at(points)
    pixels = MESH.interpolate(result.pixel_displacement, points)
    cells = [21, 47]
    for index in range(2):
        expected = [
            *moved[index],
            np.hypot(*moved[index]),
            *pixels[index],
            *strains[index],
            *strains.principal[index],
            strains.von_mises[index],
            cells[index],
            0.9,
        ]
        np.testing.assert_allclose([found[f"{name}_{index}"] for name in ALL], expected, rtol=1e-9)
    assert "residual_0_std" not in found
    assert "x_1_std" in found


def test_points_of_a_data_frame_and_surfaces_in_space_are_read() -> None:
    points = pd.DataFrame({"x": [13.0, 71.0], "y": [22.0, 44.0]})
    slanted = fedic.Mesh(np.column_stack([MESH.points, 0.5 * MESH.points[:, 0]]), MESH.cells)
    result = result_of(slanted, FIELD)
    gauge = fedic.Gauge.rectangle(10, 10, 50, 60)
    for mesh, measured in ((MESH, SERIES.result(2)), (slanted, result)):
        series = Fields(mesh, [measured])
        found = table(series, ["x", "exx"], points).loc[0]
        np.testing.assert_allclose(found[["x_0", "x_1"]].astype(float), measured.at(points)[:, 0])
        np.testing.assert_allclose(found[["exx_0", "exx_1"]].astype(float), measured.strains(at=points).exx)
        assert table(series, "exx", gauge).loc[0, "exx"] == pytest.approx(measured.strains().exx[0])


def test_axes_are_those_of_the_strains_of_a_result() -> None:
    points = [[13.0, 22.0]]
    for axes, centre in ((0.4, None), ("cylindrical", (50.0, 40.0))):
        found = table(SERIES, ["exx", "exy"], points, axes=axes, centre=centre).loc[2]  # type: ignore[arg-type]
        strains = SERIES.result(2).strains(at=points, axes=axes, centre=centre)  # type: ignore[arg-type]
        np.testing.assert_allclose([found["exx"], found["exy"]], strains[0][[0, 2]], rtol=1e-9)


def test_sets_are_means_over_their_nodes_and_cells() -> None:
    row = table(SERIES, ["y", "exx"], ["top", "left"], measure="small").loc[2]
    assert "exx_top" not in row
    assert row["y_top"] == pytest.approx(FIELD[88:99, 1].mean())
    assert row["exx_left"] == pytest.approx(0.02)
    single = table(SERIES, "y", "top").loc[2]
    assert single["y"] == row["y_top"]


def test_the_whole_mesh_is_weighted_by_area() -> None:
    mesh = fedic.Mesh([[0, 0], [1, 0], [1, 1], [0, 1], [4, 0], [4, 1]], {"quad": [[0, 1, 2, 3], [1, 4, 5, 2]]})
    x = mesh.points[:, 0]
    series = Fields(mesh, [result_of(mesh, np.column_stack([np.where(x > 1, 0.1 * x - 0.1, 0.0), 0 * x]))])
    assert table(series, "exx", measure="small").loc[0, "exx"] == pytest.approx(0.1 * 3 / 4)
    damaged = Fields(mesh, [result_of(mesh, series.result(0).displacement, damaged=[0])])
    assert table(damaged, "exx", measure="small").loc[0, "exx"] == pytest.approx(0.1)


def test_gauges_of_several_kinds_have_the_fields_they_can_have() -> None:
    gauges = [fedic.Gauge.rectangle(10, 10, 30, 30, name="area"), fedic.Gauge.extensometer((10, 10), (10, 50))]
    columns = list(table(SERIES, ["eyy", "strain"], gauges).columns[2:])
    assert columns == ["eyy_area", "eyy_area_std", "strain_1", "strain_1_std"]


@pytest.mark.parametrize(
    ("fields", "at", "options", "message"),
    [
        ("ezz", None, {}, "fields has 'ezz'; choose from x, y, magnitude, u, v, exx"),
        ([], None, {}, "fields is empty"),
        ("eyy", "bottom", {}, "no set of this name; its sets are: 'left', 'outer', 'top'"),
        ("eyy", "outer", {}, "'eyy', which cannot be read here: the set has no cells"),
        ("strain", None, {}, "only extensometers have it"),
        ("eyy", fedic.Gauge.extensometer((1, 1), (2, 2)), {}, "extensometers have strain, elongation, rotation"),
        ("eyy", [1.0, 2.0, 3.0], {}, r"at has shape \(3,\)"),
        ("eyy", ["left", 3], {}, "at has 3 among gauges"),
        ("eyy", ["left", "left"], {}, "two places named 'left'"),
        ("eyy", None, {"measure": "euler"}, "measure must be one of"),
        ("eyy", None, {"axes": "polar"}, "axes"),
    ],
)
def test_bad_arguments_are_refused_before_any_result_is_read(
    fields: Any, at: Any, options: dict[str, Any], message: str
) -> None:
    series = Fields(MESH, SERIES.results)
    with pytest.raises(fedic.OptionError, match=message):
        table(series, fields, at, **options)
    assert series.read == []


def test_frames_are_listed_with_their_rigid_motion() -> None:
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    series = Fields(MESH, [result_of(MESH, MESH.points @ turn.T + (100.0, 2.0) - MESH.points), None])
    found = frame_table(series)
    assert list(found.columns) == [
        *("time", "name", "error", "converged", "good", "residual_rms"),
        *("rigid_x", "rigid_y", "rigid_rotation"),
    ]
    np.testing.assert_allclose(found.loc[0, ["rigid_x", "rigid_y"]].astype(float), [-40 + 50, 50 + 2 - 40], atol=1e-9)
    assert found.loc[0, "rigid_rotation"] == pytest.approx(np.pi / 2)
    assert found.loc[1, "error"] == "no texture"
    assert np.isnan(found.loc[1, "rigid_x"])


def test_a_missing_package_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(
        fedic.FedicError, match=r"pandas is needed for tables of a series.*pip install 'fedic\[tables\]'"
    ):
        table(SERIES, "eyy")


@pytest.mark.parametrize("name", QUANTITIES)
def test_derivatives_of_the_fields_are_those_of_finite_differences(name: str) -> None:
    source, rule = QUANTITIES[name]
    count = {"displacement": 2, "pixels": 2, "strain": 3, "ends": 4, "quality": 3}[source]
    means, line, step = np.array([0.3, -0.2, 0.15, 0.4])[:count], np.array([2.0, 1.0]), 1e-6
    changes = [rule(means + d, line)[0] - rule(means - d, line)[0] for d in step * np.eye(count)]
    np.testing.assert_allclose(rule(means, line)[1], np.array(changes) / (2 * step), atol=1e-8)


SHAPE = (110, 130)
SMALL = fedic.rectangle_mesh((20.5, 20.5, 110.5, 90.5), 15).with_sets(
    {"set": fedic.MeshSet(nodes=np.arange(14), cells=np.arange(12))}
)


def speckle(gradient: float) -> NDArray[np.float64]:
    """Return a speckle whose material is turned and stretched, not rounded."""
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    deformed = np.stack([u, v], axis=-1).reshape(-1, 2).astype(float)
    moved = np.array([[1.0, 0.5], [-0.5, 1.5]]) * gradient + np.eye(2)
    points = (deformed - (65.0, 55.0)) @ np.linalg.inv(moved).T + (65.0, 55.0)
    return np.asarray(35 + 180 * fedic.synthetic.Speckle(5.0, seed=2).values(points).reshape(SHAPE))


def test_standard_deviations_are_those_of_noisy_measurements() -> None:
    """The scatter of 60 draws is known to 9 %; a ratio beyond 1.35 has a probability of 1e-4."""
    noise, rng, images = 2.0, np.random.default_rng(4), (speckle(0.0), speckle(0.05))
    places = {
        "point": ([[50.0, 40.0]], [*ALL[:11]]),
        "area": (fedic.Gauge.polygon([(30, 30), (90, 40), (60, 85)]), [*ALL[:11]]),
        "line": (fedic.Gauge.line((30, 30), (90, 80)), ["x", "eyy"]),
        "extensometer": (fedic.Gauge.extensometer((30, 30), (90, 80)), ["strain", "elongation", "rotation"]),
        "set": ("set", ["y", "exy"]),
        "whole": (None, ["x", "eyy", "e2"]),
    }
    correlators = []
    results = []
    for _ in range(60):
        reference, deformed = ((image + rng.normal(0, noise, SHAPE)).astype(np.float32) for image in images)
        correlators.append(fedic.Correlator(reference, SMALL, noise=noise))
        results.append(correlators[-1].correlate(deformed))
    for name, (at, fields) in places.items():
        first = table(Fields(SMALL, results[:1]), fields, at).loc[0]
        for measure in ("green-lagrange", "hencky") if name == "area" else ("green-lagrange",):
            scatter = table(WithoutNoise(SMALL, results), fields, at, measure=measure).std(numeric_only=True)  # type: ignore[arg-type]
            for each in fields:
                assert scatter[each] / first[f"{each}_std"] == pytest.approx(1.0, abs=0.35), (name, each)


class WithoutNoise(Fields):
    """A series whose noise is not known."""

    def covariance(self, index: int) -> None:
        return None


def test_standard_deviations_agree_with_the_covariance_of_the_displacement() -> None:
    images = (speckle(0.0).astype(np.float32), speckle(0.02).astype(np.float32))
    result = fedic.correlate(*images, SMALL, noise=2.0)
    covariance, points = result.covariance(), np.array([[50.0, 40.0], [81.0, 63.0]])
    found = table(Fields(SMALL, [result]), ["x", "y", "exx", "eyy", "exy", "u"], points, measure="hencky").loc[0]
    for index, point in enumerate(points):
        at = np.sqrt(np.diag(covariance.at([point])[0]))
        gauge = np.sqrt(np.diag(covariance.gauge([point], "hencky")))
        names = [f"{name}_{index}_std" for name in ("x", "y", "exx", "eyy", "exy", "u")]
        np.testing.assert_allclose([found[name] for name in names], [*at, *gauge, at[0]], rtol=1e-6)
    line = fedic.Gauge.line((30, 30), (90, 80))
    samples, _ = line.samples(typical_cell_size(SMALL))
    mean = table(Fields(SMALL, [result]), "eyy", line).loc[0, "eyy_std"]
    assert mean == pytest.approx(np.sqrt(covariance.gauge(samples)[1, 1]), rel=1e-6)
    cells = table(Fields(SMALL, [result]), "eyy", "set").loc[0, "eyy_std"]
    centres = SMALL.strains(result.displacement).positions[:12]
    assert cells == pytest.approx(np.sqrt(covariance.gauge(centres)[1, 1]), rel=1e-6)


def test_pixel_displacements_have_the_deviations_of_the_camera() -> None:
    camera = fedic.FrontParallel(10.0, (0.0, 110.0))
    mesh = fedic.rectangle_mesh((2.05, 2.05, 11.05, 9.05), 1.5)
    images = (speckle(0.0).astype(np.float32), speckle(0.02).astype(np.float32))
    series = Fields(mesh, [fedic.correlate(*images, mesh, camera, noise=2.0)])
    found = table(series, ["x", "y", "u", "v"], fedic.Gauge.rectangle(4, 4, 8, 7)).loc[0]
    assert found["u_std"] == pytest.approx(10.0 * found["x_std"], rel=1e-9)
    assert found["v_std"] == pytest.approx(10.0 * found["y_std"], rel=1e-9)
