"""Interpolation, gradients and smoothing against SciPy and NumPy."""

from typing import get_args

import numpy as np
import pytest
from scipy import ndimage

from fedic._core import INTERPOLATIONS, interpolate_image
from fedic._internal.option_choices import Interpolation


@pytest.fixture(scope="module")
def image() -> np.ndarray:
    rng = np.random.default_rng(0)
    return np.clip(ndimage.gaussian_filter(rng.uniform(-600, 855, (61, 83)), 1.0), 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    """Return points between the centres of the outermost pixels of `image`."""
    return np.random.default_rng(1).uniform((0, 0), (82, 60), (4000, 2))


def scipy_values(image: np.ndarray, pixels: np.ndarray, order: int) -> np.ndarray:
    return ndimage.map_coordinates(image.astype(float), pixels.T[::-1], order=order, mode="mirror")


def test_the_types_name_every_interpolation() -> None:
    assert get_args(Interpolation) == INTERPOLATIONS


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_grey_levels_of_the_pixels_are_reproduced(image: np.ndarray, interpolation: str) -> None:
    v, u = np.mgrid[: image.shape[0], : image.shape[1]]
    values, _ = interpolate_image(image, np.stack([u.ravel(), v.ravel()], axis=1), interpolation)
    np.testing.assert_allclose(values, image.ravel(), rtol=0, atol=1e-3)


@pytest.mark.parametrize(("interpolation", "order"), [("bilinear", 1), ("bspline3", 3), ("bspline5", 5)])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_values_agree_with_scipy(
    image: np.ndarray, pixels: np.ndarray, interpolation: str, order: int, dtype: type
) -> None:
    values, _ = interpolate_image(image.astype(dtype), pixels, interpolation)
    np.testing.assert_allclose(values, scipy_values(image, pixels, order), rtol=0, atol=1e-3)


def test_bicubic_values_agree_with_the_keys_kernel(image: np.ndarray, pixels: np.ndarray) -> None:
    def keys(t: np.ndarray) -> np.ndarray:
        t = np.abs(t)
        near, far = 1.5 * t**3 - 2.5 * t**2 + 1, -0.5 * t**3 + 2.5 * t**2 - 4 * t + 2
        return np.where(t <= 1, near, np.where(t < 2, far, 0))

    inner = pixels[(pixels > 2).all(1) & (pixels < (80, 58)).all(1)]
    whole = np.floor(inner).astype(int)
    expected = np.zeros(len(inner))
    for i in range(-1, 3):
        for j in range(-1, 3):
            u, v = whole[:, 0] + i, whole[:, 1] + j
            expected += image[v, u] * keys(inner[:, 0] - u) * keys(inner[:, 1] - v)
    np.testing.assert_allclose(interpolate_image(image, inner, "bicubic")[0], expected, rtol=0, atol=1e-3)


@pytest.mark.parametrize("interpolation", ["bicubic", "bspline3", "bspline5"])
def test_analytic_gradient_is_the_derivative_of_the_values(
    image: np.ndarray, pixels: np.ndarray, interpolation: str
) -> None:
    order = {"bspline3": 3, "bspline5": 5}.get(interpolation)
    step = 1e-4 if order else 4e-3
    _, gradients = interpolate_image(image, pixels, interpolation)
    for axis in range(2):
        offset = step * np.eye(2)[axis]
        inside = ((pixels - step > 0) & (pixels + step < (82, 60))).all(1)
        # Away from the knots, where the interpolants have a smooth derivative.
        fraction = pixels[:, axis] % 1
        inside &= (fraction > 2 * step) & (fraction < 1 - 2 * step)
        if order:
            difference = scipy_values(image, pixels + offset, order) - scipy_values(image, pixels - offset, order)
            tolerance = 1e-3
        else:
            plus, minus = (
                interpolate_image(image, pixels + s * offset, interpolation)[0].astype(float) for s in (1, -1)
            )
            difference, tolerance = plus - minus, 0.02
        np.testing.assert_allclose(gradients[inside, axis], (difference / (2 * step))[inside], rtol=0, atol=tolerance)


@pytest.mark.parametrize("interpolation", ["bilinear", "bspline3"])
def test_finite_difference_gradient_is_interpolated_central_differences(
    image: np.ndarray, pixels: np.ndarray, interpolation: str
) -> None:
    padded = np.pad(image.astype(float), 1, mode="reflect")
    differences = 0.5 * (padded[1:-1, 2:] - padded[1:-1, :-2]), 0.5 * (padded[2:, 1:-1] - padded[:-2, 1:-1])
    _, gradients = interpolate_image(image, pixels, interpolation, gradient="finite-difference")
    order = {"bilinear": 1, "bspline3": 3}[interpolation]
    for axis in range(2):
        np.testing.assert_allclose(
            gradients[:, axis], scipy_values(differences[axis], pixels, order), rtol=0, atol=1e-3
        )


@pytest.mark.parametrize(("sigma", "tolerance"), [(0.8, 0.8), (2.0, 0.02)])
def test_smoothing_is_close_to_the_sampled_gaussian_of_scipy(
    image: np.ndarray, pixels: np.ndarray, sigma: float, tolerance: float
) -> None:
    values, _ = interpolate_image(image, pixels, "bspline3", smoothing=sigma)
    smooth = ndimage.gaussian_filter(image.astype(float), sigma, mode="mirror", truncate=4)
    np.testing.assert_allclose(values, scipy_values(smooth, pixels, 3), rtol=0, atol=tolerance)


@pytest.mark.parametrize("wavelength", [5.0, 7.0, 9.0])
def test_smoothing_attenuates_waves_in_any_direction_as_a_gaussian(wavelength: float) -> None:
    v, u = np.mgrid[:60, :80].astype(float)
    points = np.random.default_rng(2).uniform((20, 20), (60, 40), (50, 2))
    for angle in (0.0, 0.4, np.pi / 4):
        kx, ky = 2 * np.pi / wavelength * np.array([np.cos(angle), np.sin(angle)])
        wave = (100.0 * np.cos(kx * u + ky * v)).astype(np.float32)
        values, _ = interpolate_image(wave, points, "bspline5", smoothing=0.8)
        expected = 100.0 * np.exp(-0.5 * (0.8 * 2 * np.pi / wavelength) ** 2) * np.cos(points @ [kx, ky])
        # The rest is the error of the interpolation.
        np.testing.assert_allclose(values, expected, rtol=0, atol=0.05)


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_points_beyond_half_a_pixel_outside_are_nan(image: np.ndarray, interpolation: str) -> None:
    points = [[-0.5, 60.5], [-0.51, 3], [3, 60.51], [np.nan, 3], [82.5, -0.5]]
    values, gradients = interpolate_image(image, points, interpolation)
    np.testing.assert_array_equal(np.isnan(values), [False, True, True, True, False])
    np.testing.assert_array_equal(np.isnan(gradients).all(1), np.isnan(values))
