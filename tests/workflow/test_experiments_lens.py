"""Quick versions of the experiments with a lens: every claim and its figures."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fedic
from fedic.demo.scene import PIXEL_MOTION, ImagePair, Scene
from fedic.experiments import Outcome, Request, run_experiment
from fedic.experiments.lens import ROUNDING, ignored_distortion, rounding_floor
from fedic.experiments.reference_images import window_mesh

STATES: dict[str, list[fedic.Progress]] = {}


@pytest.fixture(scope="module")
def quick(gmsh: Any) -> Callable[[str], Outcome]:
    found: dict[str, Outcome] = {}

    def run(name: str) -> Outcome:
        if name not in found:
            STATES[name] = []
            found[name] = run_experiment(name, Request(quick=True, progress=STATES[name].append))
        return found[name]

    return run


def verdicts(outcome: Outcome) -> dict[str, str]:
    """Return the claims that do not hold."""
    return {claim.text: claim.measured for claim in outcome.claims if not claim.holds}


def rows(outcome: Outcome, **values: object) -> list[dict[str, Any]]:
    return [row for row in outcome.rows if all(row[key] == value for key, value in values.items())]


def column(found: list[dict[str, Any]], key: str) -> np.ndarray:
    return np.array([row[key] for row in found])


@pytest.mark.parametrize("name", ["fig14", "fig15", "fig16", "distortion"])
def test_every_measurement_converges_and_reports_progress(quick: Callable[[str], Outcome], name: str) -> None:
    outcome = quick(name)
    assert outcome.name == name
    assert outcome.figures[""].axes
    assert all(row["converged"] for row in outcome.rows)
    fractions = [state.fraction or 0.0 for state in STATES[name]]
    assert fractions == sorted(fractions)
    assert fractions[0] >= 0.0
    assert fractions[-1] <= 1.0


def test_fig14_the_error_with_the_lens_is_the_rounding_error(quick: Callable[[str], Outcome]) -> None:
    outcome = quick("fig14")
    assert [text.split(",")[0] for text in verdicts(outcome)] == ["paper"]
    for cell, size, std in (("quad", 10, 3.4e-3), ("quad", 20, 1.75e-3), ("triangle", 20, 1.55e-3)):
        (row,) = rows(outcome, setting="default", quadrature="mesh", bits=8, cell=cell, size_px=size)
        assert row["std_px"] == pytest.approx(std, rel=0.06)
        assert row["bound_px"] == pytest.approx(std, rel=0.06)
    exact = rows(outcome, setting="default", quadrature="mesh", bits=16)
    assert column(exact, "bias_u_px").max() < 2e-6
    assert column(exact, "std_px").max() < 5e-5
    ignored = rows(outcome, setting="default", quadrature="pixel", bits=8)
    assert_allclose(column(ignored, "bias_u_px"), 0.0171, rtol=0.03)
    assert_allclose(column(ignored, "bias_v_px"), 0.0092, rtol=0.03)


def test_fig14_the_settings_of_the_paper_have_a_bias_at_ten_pixels(quick: Callable[[str], Outcome]) -> None:
    """The one claim that does not hold: 1e-4 px without any rounding."""
    (row,) = rows(quick("fig14"), setting="paper", quadrature="mesh", bits=16, cell="quad", size_px=10)
    assert row["bias_u_px"] == pytest.approx(1.04e-4, rel=0.05)


def test_fig15_noise_levels_off_at_one_point_per_pixel_without_smoothing(quick: Callable[[str], Outcome]) -> None:
    outcome = quick("fig15")
    assert verdicts(outcome) == {}
    line = rows(outcome, setting="unfiltered", rule="rotated", cell="triangle")
    assert_allclose(column(line, "points_per_pixel"), (0.5, 0.8, 1.0, 1.6, 2.0, 3.2, 4.0), rtol=0.08)
    relative = column(line, "std_px") / column(line, "bound_px")
    assert_allclose(relative, (1.115, 0.974, 0.967, 0.965, 0.964, 0.964, 0.964), rtol=0.02)
    (pixel,) = rows(outcome, setting="unfiltered", rule="pixel", cell="triangle")
    assert pixel["points"] == 90000
    assert pixel["std_px"] == pytest.approx(6.8e-3, rel=0.03)


def test_fig16_error_rings_follow_the_lens(quick: Callable[[str], Outcome]) -> None:
    outcome = quick("fig16")
    assert verdicts(outcome) == {}
    assert set(outcome.figures) == {"", "paper"}
    (exact,) = rows(outcome, setting="default", quadrature="pixel", bits=16)
    assert exact["correlation_u"] > 0.9999
    assert exact["std_from_theory_px"] < 2e-5
    (rounded,) = rows(outcome, setting="default", quadrature="pixel", bits=8)
    assert 0.95 < rounded["correlation_v"] < 0.98
    (lens,) = rows(outcome, setting="default", quadrature="mesh", bits=8)
    assert abs(lens["correlation_u"]) < 0.2


def test_distortion_biases_only_without_the_lens_in_the_projector(quick: Callable[[str], Outcome]) -> None:
    outcome = quick("distortion")
    assert verdicts(outcome) == {}
    case = {"setting": "default", "bits": 8, "value": -0.3, "focal_px": 8381.24}
    (lens,) = rows(outcome, lens=True, **case)
    (ignored,) = rows(outcome, lens=False, **case)
    assert lens["corner_px"] == pytest.approx(2.79, abs=0.01)
    assert lens["rms_px"] == pytest.approx(lens["bound_px"], rel=0.1)
    assert ignored["rms_px"] == pytest.approx(0.143, rel=0.01)
    (none,) = rows(outcome, lens=False, setting="default", bits=16, coefficient="none")
    assert none["rms_px"] < 5e-5


def test_the_bias_without_the_lens_is_the_difference_of_distortions(gmsh: Any) -> None:
    """``x (1 + k1 r^2)`` in normalised image coordinates, at the node before and after the motion."""
    scene = Scene()
    mesh = window_mesh(scene.window, 30.0, "quad")
    focal, centre, k1 = 8381.24, np.array([706.053, 503.725]), -0.0321253
    seen = (mesh.points - centre) / focal
    ideal = seen.copy()
    for _ in range(20):
        ideal = seen / (1.0 + k1 * (ideal**2).sum(axis=1, keepdims=True))
    arrived = ideal + np.array([-400.0, -200.0]) / focal
    moved = focal * (arrived * (1.0 + k1 * (arrived**2).sum(axis=1, keepdims=True)) - seen)
    assert_allclose(ignored_distortion(scene, mesh), moved - PIXEL_MOTION, rtol=0.0, atol=1e-8)
    assert_allclose(scene.camera.project(scene.in_millimetres(mesh).points), mesh.points, rtol=0.0, atol=1e-8)


def test_the_rounding_floor_is_the_error_of_a_translation() -> None:
    """A sine of 20 px along u and v, whose mean squared slope is known."""
    scene = Scene()
    v, u = np.mgrid[:1036, :1388]
    wave = 100.0 + 50.0 * (np.sin(2.0 * np.pi * u / 20.0) + np.sin(2.0 * np.pi * v / 20.0))
    slope = 50.0 * 2.0 * np.pi / 20.0 / np.sqrt(2.0)
    expected = np.sqrt(2.0) * ROUNDING / (slope * 300.0)
    assert_allclose(rounding_floor(scene, ImagePair(wave, wave)), expected, rtol=0.02)


def test_rounding_to_8_bits_keeps_the_grey_levels() -> None:
    fine = np.array([[0, 128, 129, 65535]], dtype=np.uint16)
    pair = ImagePair(fine, fine[:, ::-1]).rounded()
    assert pair.reference.tolist() == [[0, 0, 1, 255]]
    assert pair.deformed.tolist() == [[255, 1, 0, 0]]
