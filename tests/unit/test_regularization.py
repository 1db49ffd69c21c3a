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


def mean_squared_shape_functions(cell: str) -> float:
    """Return the mean over a cell of the sum of its squared shape functions."""
    mesh = fedic.rectangle_mesh((0.0, 0.0, 1.0, 1.0), 1.0, cell)  # type: ignore[arg-type]
    middles = (np.arange(400.0) + 0.5) / 400.0
    points = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    return float((mesh.interpolate(np.eye(mesh.num_nodes), points) ** 2).sum(axis=1).mean())


@pytest.mark.parametrize("cell", CELLS)
def test_a_wave_of_the_regularization_length_is_lowered_by_a_known_factor(
    scene: tuple[int, NDArray[np.float32], NDArray[np.float32]], cell: str
) -> None:
    """In the middle of a mesh whose cells, of 10 px, are small against the wavelength.

    The penalty weighs a wave of that length as the trace of the Hessian does, which is ``s`` times the squared
    gradient of the image, ``s`` the mean of the sum of the squared shape functions. The amplitude left is ``1 / (1 +
    s)``: 0.67 (triangle), 0.61 (triangle6), 0.69 (quad), 0.54 (quad8), 0.61 (quad9). Measured: 0.65, 0.61, 0.68, 0.53,
    0.60.
    """
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
    expected = 1.0 / (1.0 + mean_squared_shape_functions(cell))
    assert amplitude_left(PERIOD) == pytest.approx(expected, abs=0.025)


def test_a_very_long_regularization_length_leaves_a_translation(
    scene: tuple[int, NDArray[np.float32], NDArray[np.float32]],
) -> None:
    _, reference, _ = scene
    moved = np.roll(reference, (1, 2), axis=(0, 1))
    moved[:, 170:] = np.roll(reference, (1, 3), axis=(0, 1))[:, 170:]
    mesh = fedic.rectangle_mesh(BOUNDS, 20.0)
    result = fedic.correlate(reference, moved, mesh, initial="pyramid", regularization_length=5000.0)
    assert result.converged
    assert result.displacement.std(axis=0).max() < 0.02
    np.testing.assert_allclose(result.displacement.mean(axis=0), [2.5, 1.0], atol=0.1)
