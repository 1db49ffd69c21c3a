"""Rotations and strains of any size: number of iterations, and the error that smoothing leaves."""

from functools import lru_cache

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.experiments.waves import Waves

Floats = NDArray[np.float64]
SIZE = 300
CENTRE = np.array([0.5 * SIZE, 0.5 * SIZE])


WAVES = Waves(4)


@lru_cache(maxsize=1)
def reference() -> NDArray[np.float32]:
    return WAVES.image(SIZE, np.eye(2))


def turned(degrees: float, stretch: float = 0.0) -> Floats:
    angle = np.radians(degrees)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return rotation @ np.diag([1.0 + stretch, 1.0])


def measured(gradient: Floats, cell: str, size: float, **options: object) -> tuple[fedic.Result, Floats]:
    """Measure a deformation from a start within one pixel; return the errors of the nodes as well."""
    mesh = fedic.rectangle_mesh((72, 72, 228, 228), size, cell)
    points = mesh.points[:, :2]
    truth = (points - CENTRE) @ (gradient - np.eye(2)).T
    start = truth + 0.5 * np.sin(points[:, ::-1] / 40.0)
    result = fedic.correlate(reference(), WAVES.image(SIZE, gradient), mesh, initial=start, **options)  # type: ignore[arg-type]
    return result, result.displacement[:, :2] - truth


@pytest.mark.parametrize("hessian", ["initial", "updated"])
@pytest.mark.parametrize(("degrees", "stretch"), [(45, 0), (90, 0), (135, 0), (170, 0), (0, 0.5), (60, 0.3)])
def test_large_deformations_take_two_more_iterations_than_none(degrees: float, stretch: float, hessian: str) -> None:
    at_rest, _ = measured(turned(0.0), "quad", 20.0, hessian=hessian)
    result, errors = measured(turned(degrees, stretch), "quad", 20.0, hessian=hessian)
    assert result.converged
    assert result.iterations <= at_rest.iterations + 2
    assert np.abs(errors).max() < 2e-3


@pytest.mark.parametrize("degrees", [0.0, 45.0])
@pytest.mark.parametrize(
    # The first is not corrected.
    ("stretch", "accepted"),
    [(0.0024, 1.5e-4), (0.01, 1e-4), (0.05, 1e-4), (0.2, 1.5e-4), (-0.2, 1.5e-4)],
)
def test_smoothing_does_not_bias_strain(degrees: float, stretch: float, accepted: float) -> None:
    result, errors = measured(turned(degrees, stretch), "quad", 20.0)
    assert result.converged
    assert np.sqrt(np.mean(errors**2)) < accepted
    assert np.abs(errors.mean(axis=0)).max() < 5e-5
    # The residual is that of the images smoothed alike.
    assert result.residual_rms < 0.4


def test_the_error_left_by_the_iterations_is_estimated() -> None:
    """A smoothed displacement converges slowly: the last correction says little about the rest."""
    gradient = turned(45.0, 0.02)
    exact, _ = measured(gradient, "quad", 20.0, tolerance=1e-9)
    for tolerance in (1e-1, 1e-2, 1e-3):
        result, _ = measured(gradient, "quad", 20.0, tolerance=tolerance)
        left = np.linalg.norm(result.displacement - exact.displacement, axis=1).max()
        assert result.error_left <= tolerance
        assert left <= 1.5 * result.error_left + 1e-6


@pytest.mark.parametrize(("degrees", "stretch"), [(0.0, 0.0), (60.0, 0.0), (30.0, 0.4), (0.0, -0.25)])
def test_predicted_deviations_follow_the_deformation(degrees: float, stretch: float) -> None:
    gradient, noise, draws = turned(degrees, stretch), 3.0, 60
    mesh = fedic.rectangle_mesh((72, 72, 228, 228), 26.0)
    truth = (mesh.points - CENTRE) @ (gradient - np.eye(2)).T
    images = [image.astype(np.float64) for image in (reference(), WAVES.image(SIZE, gradient))]
    rng = np.random.default_rng(1)
    found = []
    for _ in range(draws):
        noisy = [(image + rng.normal(0.0, noise, image.shape)).astype(np.float32) for image in images]
        correlator = fedic.Correlator(noisy[0], mesh, noise=noise)
        found.append(correlator.correlate(noisy[1], initial=truth).displacement)
    predicted = fedic.Correlator(reference(), mesh).standard_deviations(noise, truth)
    inner = ((mesh.points > 80) & (mesh.points < 220)).all(axis=1)
    ratio = np.std(found, axis=0, ddof=1)[inner] / predicted[inner]
    for component in ratio.T:
        assert np.sqrt(np.mean(component**2)) == pytest.approx(1.0, abs=0.08)
