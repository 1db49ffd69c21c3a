"""The length of a regularization chosen by pixels that are left out."""

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.typing import NDArray

import fedic
from fedic.cross_validation.left_out import MOST_PATTERNS, SIDE, left_out, square_sums
from fedic.cross_validation.measure import _curve

Floats = NDArray[np.float64]
SHAPE = (220, 220)
LOW, HIGH = 30.0, 190.0


def noisy_wave(period: float, amplitude: float, noise: float, seed: int) -> tuple[NDArray[np.float32], ...]:
    """Return images before and after a shear wave."""
    texture, generator = fedic.synthetic.Speckle(4.0, seed=seed), np.random.default_rng(seed)
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(float)
    pixels = np.column_stack([u.ravel(), v.ravel()])
    origins = pixels.copy()
    origins[:, 1] -= amplitude * np.sin(2.0 * np.pi * pixels[:, 0] / period)

    def image(points: Floats) -> NDArray[np.float32]:
        grey = (35.0 + 180.0 * texture.values(points)).reshape(SHAPE)
        return (grey + generator.normal(0.0, noise, SHAPE)).astype(np.float32)

    return image(pixels), image(origins)


@pytest.mark.parametrize(
    ("period", "amplitude", "noise", "regularization"),
    [
        (160.0, 0.3, 4.0, "smooth"),
        (80.0, 0.3, 2.0, "smooth"),
        (160.0, 0.3, 4.0, fedic.EquilibriumGap(loaded=[])),
        (60.0, 0.3, 5.0, fedic.EquilibriumGap(loaded=[])),
    ],
)
@pytest.mark.filterwarnings("ignore::fedic.QualityWarning")
def test_the_best_length_has_nearly_the_least_error(
    period: float, amplitude: float, noise: float, regularization: Any
) -> None:
    images, mesh = noisy_wave(period, amplitude, noise, seed=1), fedic.rectangle_mesh((LOW, LOW, HIGH, HIGH), 10.0)
    lengths = 20.0 * 2.0 ** (0.5 * np.arange(7))
    curve = fedic.regularization_curve(*images, mesh, lengths=lengths, regularization=regularization)
    places = np.random.default_rng(0).uniform(LOW, HIGH, (10000, 2))

    def error(length: float) -> float:
        result = fedic.correlate(*images, mesh, regularization=regularization, regularization_length=length)
        found = mesh.interpolate(result.unchecked_displacement, places)
        found[:, 1] -= amplitude * np.sin(2.0 * np.pi * places[:, 0] / period)
        return float(np.sqrt((found**2).mean()))

    errors = np.array([error(length) for length in lengths])
    chosen = errors[lengths == curve.best_length][0]
    assert chosen <= 1.2 * errors.min(), (errors, curve.left_out_rms)
    # The lengths of the test are not all equally good.
    assert errors.max() > 2.0 * errors.min()
    assert curve.left_out_error[lengths == curve.best_length] == 0.0
    assert curve.residual_rms.shape == lengths.shape


def test_each_pixel_is_left_out_once() -> None:
    patterns = [left_out((50, 61), pattern) for pattern in range(MOST_PATTERNS)]
    assert (np.sum(patterns, axis=0) == 1).all()


def test_squares_are_read_without_their_border_and_without_pixels_that_were_not_measured() -> None:
    residual = np.full((5 * SIDE, 6 * SIDE), 2.0, dtype=np.float32)
    residual[3, 3] = np.nan
    counts, sums = square_sums(residual, 0)
    assert counts[0] == (SIDE - 2) ** 2 - 1
    assert set(counts[1:]) == {0.0, (SIDE - 2.0) ** 2}
    np.testing.assert_allclose(sums, 4.0 * counts)
    np.testing.assert_array_equal(np.flatnonzero(counts), [0, 3, 21, 24])


def test_pixels_that_some_length_does_not_read_count_for_none_and_lengths_that_fail_are_nan() -> None:
    both, first = np.array([25.0, 25.0, 0.0]), np.array([25.0, 24.0, 0.0])
    rows = [
        (both, np.array([50.0, 1e6, 0.0]), 1.0),
        (first, np.array([25.0, 0.0, 0.0]), 1.0),
        (both, np.array([np.nan, np.nan, np.nan]), 1.0),
    ]
    curve = _curve(np.array([1.0, 2.0, 3.0]), rows)
    np.testing.assert_allclose(curve.left_out_rms, [np.sqrt(2.0), 1.0, np.nan])
    assert curve.best_length == 2.0
    with pytest.raises(fedic.SolveError, match="no length"):
        _curve(np.array([1.0, 2.0]), rows[2:] * 2)


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        ({"lengths": [10.0]}, "lengths"),
        ({"lengths": [10.0, -1.0]}, "lengths"),
        ({"lengths": ["a", "b"]}, "lengths"),
        ({"patterns": 0}, "patterns"),
        ({"patterns": 10}, "patterns"),
        ({"regularization_length": 10.0}, "regularization_length"),
        ({"regularization": "none"}, "regularization"),
        ({"smooothing": 1.0}, "smooothing"),
    ],
)
def test_wrong_arguments_are_named(arguments: dict[str, Any], option: str) -> None:
    image = noisy_wave(80.0, 0.3, 1.0, seed=1)[0]
    with pytest.raises(fedic.OptionError) as caught:
        fedic.regularization_curve(image, image, fedic.rectangle_mesh((LOW, LOW, HIGH, HIGH), 20.0), **arguments)
    assert caught.value.option == option


def test_lengths_by_default_span_the_mesh_and_the_curve_is_drawn() -> None:
    images = noisy_wave(160.0, 0.3, 2.0, seed=2)
    curve = fedic.regularization_curve(*images, fedic.rectangle_mesh((LOW, LOW, HIGH, HIGH), 20.0), patterns=1)
    np.testing.assert_allclose(curve.lengths, 50.0 * 2.0 ** (0.5 * np.arange(4)))
    figure = curve.plot()
    assert isinstance(figure, Figure)
    assert figure.axes[0].get_xlabel() == "regularization length (px)"
    assert f"best: {curve.best_length:.4g} px" in [text.get_text() for text in figure.axes[0].get_legend().texts]
    assert "4 lengths from 50 to 141.4 px" in repr(curve)
