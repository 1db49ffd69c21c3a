"""The regularization against its definition: how much it lowers the amplitude of a wave."""

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic

SHAPE = (340, 340)
BOUNDS = (20.3, 20.3, 320.3, 320.3)
PERIOD, AMPLITUDE = 80.0, 0.3
CELLS = ["triangle", "triangle6", "quad", "quad8", "quad9"]


def wave(along: NDArray[np.float64]) -> NDArray[np.float64]:
    return AMPLITUDE * np.sin(2.0 * np.pi * along / PERIOD)


@pytest.fixture(scope="module", params=[0, 1], ids=["transverse", "longitudinal"])
def scene(request: pytest.FixtureRequest) -> tuple[int, NDArray[np.float32], NDArray[np.float32]]:
    """Return the axis of a wave in the v component, and images before and after it."""
    axis, texture = request.param, fedic.synthetic.Speckle(4.0, seed=1)
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(float)
    pixels = np.column_stack([u.ravel(), v.ravel()])
    material = pixels.copy()
    for _ in range(30):
        material[:, 1] = pixels[:, 1] - wave(material[:, axis])
    reference, deformed = (
        (35.0 + 180.0 * texture.values(points)).reshape(SHAPE).astype(np.float32) for points in (pixels, material)
    )
    return axis, reference, deformed


@pytest.mark.parametrize("cell", CELLS)
def test_a_wave_of_the_regularization_length_is_halved(
    scene: tuple[int, NDArray[np.float32], NDArray[np.float32]], cell: str
) -> None:
    """In the middle of a mesh, whose cells of 10 px are small against the wavelength."""
    axis, reference, deformed = scene
    mesh = fedic.rectangle_mesh(BOUNDS, 10.0, cell)  # type: ignore[arg-type]
    points = np.random.default_rng(0).uniform(90.0, 250.0, (4000, 2))
    phase = 2.0 * np.pi * points[:, axis] / PERIOD
    columns = np.column_stack([np.sin(phase), np.cos(phase), np.ones(len(points))])

    def amplitude_left(length: float | None) -> float:
        result = fedic.correlate(reference, deformed, mesh, regularization_length=length, smoothing=0.0, tolerance=1e-5)
        assert result.converged
        return float(np.linalg.lstsq(columns, result.at(points)[:, 1], rcond=None)[0][0]) / AMPLITUDE

    assert amplitude_left(None) == pytest.approx(1.0, abs=0.003)
    assert amplitude_left(PERIOD) == pytest.approx(0.5, abs=0.025)


def test_a_very_long_regularization_length_leaves_an_affine_field(
    scene: tuple[int, NDArray[np.float32], NDArray[np.float32]],
) -> None:
    _, reference, _ = scene
    moved = np.roll(reference, (1, 2), axis=(0, 1))
    moved[:, 170:] = np.roll(reference, (1, 3), axis=(0, 1))[:, 170:]
    mesh = fedic.rectangle_mesh(BOUNDS, 20.0)
    result = fedic.correlate(reference, moved, mesh, initial="pyramid", regularization_length=5000.0)
    assert result.converged
    affine = np.column_stack([mesh.points[:, :2], np.ones(mesh.num_nodes)])
    fitted = affine @ np.linalg.lstsq(affine, result.displacement, rcond=None)[0]
    np.testing.assert_allclose(result.displacement, fitted, atol=0.02)
    np.testing.assert_allclose(fitted.mean(axis=0), [2.5, 1.0], atol=0.1)


def rotation(degrees: float) -> NDArray[np.float64]:
    angle = np.deg2rad(degrees)
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize("length", [40.0, 100.0, 200.0])
@pytest.mark.parametrize(
    "gradient",
    [np.diag([1.01, 0.997]), np.diag([1.05, 0.985]), rotation(2.0), rotation(5.0)],
    ids=["1 %", "5 %", "2 degrees", "5 degrees"],
)
def test_uniform_strain_and_rotation_are_left_alone_up_to_the_free_edges(
    gradient: NDArray[np.float64], length: float
) -> None:
    """Without regularization the largest error is 0.01 px, and that of a strain 4e-4."""
    texture, centre = fedic.synthetic.Speckle(4.0, seed=3), np.array([250.0, 200.0])
    v, u = np.mgrid[:400, :500].astype(float)
    pixels = np.column_stack([u.ravel(), v.ravel()])
    origins = (pixels - centre) @ np.linalg.inv(gradient).T + centre
    reference, deformed = (
        np.round(35.0 + 180.0 * texture.values(points)).reshape(u.shape).astype(np.uint8)
        for points in (pixels, origins)
    )
    mesh = fedic.rectangle_mesh((120, 100, 380, 300), size=20)
    result = fedic.correlate(reference, deformed, mesh, initial="pyramid", regularization_length=length)
    assert result.converged
    expected = (mesh.points[:, :2] - centre) @ (gradient - np.eye(2)).T
    assert np.abs(result.displacement - expected).max() < 0.01


def test_noise_and_resolution_of_a_regularized_result(
    scene: tuple[int, NDArray[np.float32], NDArray[np.float32]],
) -> None:
    _, reference, _ = scene
    mesh = fedic.rectangle_mesh(BOUNDS, 20.0)
    plain = fedic.correlate(reference, reference, mesh)
    smooth = fedic.correlate(reference, reference, mesh, regularization_length=120.0)
    assert (plain.resolution, smooth.resolution) == (None, 120.0)
    assert smooth.summary()["resolution"] == 120.0
    lowered = np.linalg.norm(smooth.standard_deviations(1.0)) / np.linalg.norm(plain.standard_deviations(1.0))
    assert lowered == pytest.approx(0.177, rel=0.05)
