"""Robust weights, brightness as a field and cuts: the good part of a specimen is measured, the damage named."""

import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest

import fedic
from scenes.damaged_plate import LINE, NOISE, OPENING, Damaged, damaged, good_nodes, hidden_shares

BOUNDS = (79.5, 79.5, 239.5, 239.5)
CELLS = {"quad": 16.0, "triangle": 16.0, "triangle6": 32.0, "quad8": 32.0, "quad9": 32.0}
FACTORS = {"clean": 1.1, "chips": 1.1, "crack": 1.1, "shadow": 1.3}
"""Largest error, root mean square, in predicted standard deviations."""
SHADOW_OF_QUADRATIC = 1.7
"""The same of a shadow in cells of 32 px, whose light is less smooth than they can follow."""


def measured(scene: Damaged, mesh: fedic.Mesh, **options: object) -> fedic.Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fedic.QualityWarning)
        return fedic.correlate(scene.reference, scene.deformed, mesh, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", FACTORS)
@pytest.mark.parametrize(
    ("cell", "function"), [("quad", "tukey"), ("quad", "huber"), *((cell, "tukey") for cell in CELLS if cell != "quad")]
)
def test_good_nodes_are_as_accurate_as_predicted_and_damage_is_flagged(kind: str, cell: str, function: str) -> None:
    scene, mesh = damaged(kind), fedic.rectangle_mesh(BOUNDS, CELLS[cell], cell)  # type: ignore[arg-type]
    result = measured(scene, mesh, robust=function, noise=NOISE)
    shares = hidden_shares(mesh, scene)
    error = np.linalg.norm(result.displacement - scene.displacement(mesh.points[:, :2]), axis=1)
    good = good_nodes(mesh, shares)
    assert result.converged
    assert np.isfinite(error[good]).all()
    predicted = np.linalg.norm(result.standard_deviations(), axis=1)
    ratio = np.sqrt(np.mean(error[good] ** 2) / np.mean(predicted[good] ** 2))
    is_wide = kind == "shadow" and CELLS[cell] > 20.0
    assert ratio <= (SHADOW_OF_QUADRATIC if is_wide else FACTORS[kind]), ratio
    flagged = result.quality.cell_flags != 0
    if kind == "chips":
        assert flagged[shares > 0.25].all()
    if kind == "crack":
        across = np.abs(mesh.points[:, 1] - LINE)
        cells = [each for block in mesh.cells.values() for each in block]
        cut = [np.ptp(np.sign(mesh.points[nodes, 1] - LINE)) == 2 and across[nodes].max() > 1 for nodes in cells]
        assert flagged[np.array(cut)].all()
    assert flagged[shares == 0.0].sum() <= max(1, 0.03 * np.sum(shares == 0.0))
    assert not np.any((error > 0.3) & (result.quality.node_flags == 0))


def test_without_damage_no_point_is_weighed() -> None:
    scene, mesh = damaged("clean"), fedic.rectangle_mesh(BOUNDS, 16.0)
    robust, plain = (measured(scene, mesh, robust=function, brightness="field") for function in ("tukey", None))
    np.testing.assert_array_equal(robust.quality.kept_share, 1.0)
    assert robust.information is None
    np.testing.assert_allclose(robust.displacement, plain.displacement, atol=2e-3)


def test_damage_spoils_a_measurement_without_weights() -> None:
    """The scenes are hard enough: without weights good nodes are wrong by several standard deviations."""
    for kind in ("chips", "crack"):
        scene, mesh = damaged(kind), fedic.rectangle_mesh(BOUNDS, 16.0)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = fedic.correlate(scene.reference, scene.deformed, mesh, initial="pyramid")
        error = np.linalg.norm(result.unchecked_displacement - scene.displacement(mesh.points[:, :2]), axis=1)
        assert np.sqrt(np.mean(error[good_nodes(mesh, hidden_shares(mesh, scene))] ** 2)) > 0.06


def test_weights_do_not_depend_on_the_number_of_threads() -> None:
    scene, mesh = damaged("chips"), fedic.rectangle_mesh(BOUNDS, 16.0)
    one, two = (measured(scene, mesh, robust="tukey", num_threads=number) for number in (1, 2))
    np.testing.assert_array_equal(one.displacement, two.displacement)
    np.testing.assert_array_equal(one.standard_deviations(), two.standard_deviations())


def test_files_and_pickles_hold_the_deviations_of_damaged_results(tmp_path: Path) -> None:
    scene, mesh = damaged("chips"), fedic.rectangle_mesh(BOUNDS, 16.0)
    result = measured(scene, mesh, robust="tukey")
    arrays = np.load(result.write(tmp_path / "result.npz"))
    np.testing.assert_array_equal(np.isnan(arrays["standard_deviations"]).any(axis=1), ~result.valid_nodes)
    np.testing.assert_array_equal(np.isnan(arrays["strain_standard_deviations"]).any(axis=1), ~result.valid_cells)
    assert arrays["cell_kept_share"].min() < 0.7
    copy = pickle.loads(pickle.dumps(result))
    assert [len(part) for part in copy.information] == [len(part) for part in result.information]  # type: ignore[union-attr,arg-type]


@pytest.mark.parametrize("brightness", ["field", "element"])
def test_a_slope_of_light_leaves_no_residual(brightness: str) -> None:
    scene, mesh = damaged("clean"), fedic.rectangle_mesh(BOUNDS, 16.0)
    v, u = np.mgrid[: len(scene.deformed), : len(scene.deformed)]
    shaded = scene.deformed * (0.75 + 0.3 * (u - 160) / 320 - 0.2 * (v - 160) / 320)
    result = measured(
        Damaged(scene.reference, np.rint(shaded).astype(np.uint8), scene.displacement, scene.hidden),
        mesh,
        brightness=brightness,
    )
    error = np.linalg.norm(result.displacement - scene.displacement(mesh.points[:, :2]), axis=1)
    residual = result.residual_map()
    assert not result.quality.cell_flags.any()
    assert np.sqrt(np.mean(error**2)) < 0.04
    assert np.nanstd(residual) < 1.6


def cut_mesh(cell: str) -> fedic.Mesh:
    mesh = fedic.rectangle_mesh((79.5, 95.5, 239.5, 223.5), CELLS[cell], cell)  # type: ignore[arg-type]
    return mesh.split([(79.5, LINE), (239.5, LINE)])


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("function", ["tukey", None])
def test_the_opening_of_a_cut_is_measured(cell: str, function: str | None) -> None:
    """Over three draws; without weights the points within 2 px of the cut are left out."""
    mesh = cut_mesh(cell)
    left, right = mesh.coincident_nodes().T
    openings, scores = [], []
    for seed in range(3):
        scene = damaged("crack", seed)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = fedic.correlate(scene.reference, scene.deformed, mesh, robust=function, noise=NOISE)  # type: ignore[arg-type]
        jump = result.displacement[left] - result.displacement[right]
        assert result.converged
        openings.append(np.abs(jump[:, 1]))
        deviations = result.standard_deviations()
        scores.append((np.abs(jump[:, 1]) - OPENING) / np.hypot(deviations[left, 1], deviations[right, 1]))
    assert np.nanmean(openings) == pytest.approx(OPENING, abs=0.03 if function else 0.1)
    if function:
        assert np.sqrt(np.nanmean(np.square(scores))) < 1.4
