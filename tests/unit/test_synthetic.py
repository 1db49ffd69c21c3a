"""Synthetic images against their texture; noise and Fourier shifts against their definition."""

import threading
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.demo.scene import FOCAL, MILLIMETRES, Scene
from fedic.synthetic import Displacement, Speckle, add_noise, fourier_shift, render

Floats = NDArray[np.float64]

DISTANCE = MILLIMETRES * FOCAL


def pinhole(focal: float, principal_point: tuple[float, float], k1: float, tilt: float = 0.0) -> fedic.Pinhole:
    return fedic.Pinhole(
        (focal, focal),
        principal_point,
        rotation=(np.pi + tilt, 0.0, 0.0),
        translation=(0.0, 0.0, DISTANCE),
        distortion=fedic.BrownDistortion(radial=(k1, 0.0, 0.0)),
    )


DEMO_CAMERA = Scene().camera
CAMERAS = {
    "frame": fedic.ImageFrame(),
    "front": fedic.FrontParallel(1.0 / MILLIMETRES, (3.0, 40.0)),
    "lens": DEMO_CAMERA,
}


def sample_pixels(rows: tuple[int, int], width: int, supersampling: int) -> Floats:
    """Return the image points of all samples, pixel by pixel."""
    offsets = (np.arange(supersampling) + 0.5) / supersampling - 0.5
    v, u, dv, du = np.meshgrid(np.arange(*rows), np.arange(width), offsets, offsets, indexing="ij")
    return np.stack([u + du, v + dv], axis=-1).reshape(-1, 2)


def test_pixels_without_a_point_on_the_plane_are_refused() -> None:
    folded = pinhole(1000.0, (500.0, 500.0), -1.0)
    message = r"pixels in rows 0 to 54 see no point of the plane, the first at \(u = 0, v = 0\)"
    with pytest.raises(fedic.CameraError, match=message):
        render(Speckle(3.0), folded, (1000, 1000))
    with pytest.raises(fedic.OptionError, match="do not fit in memory"):
        render(Speckle(3.0), folded, (10, 4_000_000_000), supersampling=4_000_000)


@pytest.mark.parametrize("name", list(CAMERAS))
def test_an_image_is_the_mean_of_the_texture_over_the_pixels(name: str) -> None:
    camera = CAMERAS[name]
    texture = Speckle(5.5 * (1.0 if name == "frame" else MILLIMETRES), seed=2)
    points = camera.unproject(sample_pixels((0, 40), 50, 3))
    expected = texture.values(points).reshape(40, 50, 9).mean(axis=2)
    image = render(texture, camera, (40, 50), levels=(0.2, 0.7), bits=16)
    np.testing.assert_allclose(image, 65535 * (0.2 + 0.5 * expected), rtol=0, atol=0.51)


def waves(amplitude: float, period: float) -> Callable[[Floats], Floats]:
    def displacement(points: Floats) -> Floats:
        phase = 2.0 * np.pi * points[:, ::-1] / period
        return np.asarray(amplitude * np.sin(phase + np.array([0.3, 1.1])))

    return displacement


@pytest.mark.parametrize("name", list(CAMERAS))
def test_a_displaced_image_samples_the_texture_at_inverted_positions(name: str) -> None:
    camera = CAMERAS[name]
    pixel = 1.0 if name == "frame" else MILLIMETRES
    texture, displacement = Speckle(5.5 * pixel, seed=2), waves(2.0 * pixel, 60.0 * pixel)
    positions = camera.unproject(sample_pixels((0, 40), 50, 3))[:, :2]
    # Newton's method with a Jacobian by differences; render iterates on X = Y - U(X).
    points, step = positions.copy(), 1e-6 * pixel
    for _ in range(8):
        slopes = [(displacement(points + h) - displacement(points - h)) / (2.0 * step) for h in step * np.eye(2)]
        residual = points + displacement(points) - positions
        points -= np.linalg.solve(np.eye(2) + np.stack(slopes, axis=-1), residual[..., np.newaxis])[..., 0]
    assert np.abs(points + displacement(points) - positions).max() < 1e-10 * pixel
    assert np.abs(points - positions).max() > 1.5 * pixel
    expected = texture.values(points).reshape(40, 50, 9).mean(axis=2)
    image = render(texture, camera, (40, 50), displacement=displacement, levels=(0.0, 1.0), bits=16)
    np.testing.assert_allclose(image, 65535 * expected, rtol=0, atol=0.51)


@pytest.mark.parametrize(
    ("displacement", "words"),
    [
        (lambda points: np.zeros(2), r"must be a 2-dimensional array of real numbers, got an array of shape \[2\]"),
        (lambda points: np.zeros((3, 2)), r"displacement of points \(3600, 2\) must have that shape, got \(3, 2\)"),
        (lambda points: np.zeros((3600, 3)), r"displacement must have shape \(n, 2\), got \[3600, 3\]"),
        ((1.0, 2.0, 3.0), "give a pair of numbers"),
        (lambda points: 3.0 * points, "could not be inverted in 60 fixed-point iterations"),
        (lambda points: np.full_like(points, np.nan), "could not be inverted"),
    ],
)
def test_bad_displacements_are_refused(displacement: Displacement, words: str) -> None:
    with pytest.raises(fedic.OptionError, match=words):
        render(Speckle(5.0), fedic.ImageFrame(), (20, 20), displacement=displacement)


def test_exceptions_of_the_displacement_and_of_progress_are_raised() -> None:
    def fail(argument: object) -> Floats:
        raise LookupError("on purpose")

    with pytest.raises(LookupError, match="on purpose"):
        render(Speckle(5.0), fedic.ImageFrame(), (20, 20), displacement=fail)
    with pytest.raises(LookupError, match="on purpose"):
        render(Speckle(5.0), fedic.ImageFrame(), (20, 20), progress=fail)


def test_functions_of_the_caller_run_on_its_thread() -> None:
    threads: set[int] = set()

    def note(argument: object) -> None:
        threads.add(threading.get_ident())

    def displacement(points: Floats) -> Floats:
        note(points)
        return np.zeros_like(points)

    render(Speckle(5.0), fedic.ImageFrame(), (20, 20), displacement=displacement, progress=note)
    assert threads == {threading.get_ident()}


def test_texture_values_do_not_depend_on_the_batch_size() -> None:
    texture = Speckle(0.7, seed=9)
    points = np.random.default_rng(0).uniform(-50.0, 50.0, (300, 3))
    one_by_one = np.concatenate([texture.values(point[np.newaxis]) for point in points])
    np.testing.assert_array_equal(texture.values(points), one_by_one)
    np.testing.assert_array_equal(texture.values(np.asfortranarray(points[:, :2])), one_by_one)
    np.testing.assert_array_equal(texture.values(points[:, :2].tolist()), one_by_one)


def test_render_moves_the_material_by_the_displacement() -> None:
    texture, camera = Speckle(5.0, seed=3), fedic.ImageFrame()
    still = render(texture, camera, (60, 80))
    moved = render(texture, camera, (60, 80), displacement=(7.0, 4.0))
    np.testing.assert_array_equal(moved[4:, 7:], still[:-4, :-7])


def test_render_inverts_a_displacement_field() -> None:
    texture, camera = Speckle(5.0, seed=3), fedic.ImageFrame()
    constant = render(texture, camera, (30, 40), displacement=(2.5, -1.0))
    as_field = render(texture, camera, (30, 40), displacement=lambda points: np.tile((2.5, -1.0), (len(points), 1)))
    np.testing.assert_array_equal(constant, as_field)
    stretched = render(texture, camera, (30, 40), displacement=lambda points: 0.25 * points)
    rendered = texture.values(np.array([[20.0, 12.0]]) / 1.25)
    point = render(texture, camera, (30, 40), displacement=lambda points: 0.25 * points, supersampling=1)
    assert abs(point[12, 20] / 255.0 - (0.1 + 0.8 * rendered[0])) < 0.003
    assert stretched.shape == (30, 40)
    with pytest.raises(fedic.OptionError, match="could not be inverted in 60 fixed-point iterations"):
        render(texture, camera, (30, 40), displacement=lambda points: 2.0 * points)


def test_render_applies_depth_noise_and_seed() -> None:
    texture, camera = Speckle(5.0), fedic.ImageFrame()
    clean = render(texture, camera, (100, 100), bits=12)
    assert clean.dtype == np.uint16
    assert 255 < clean.max() <= 4095
    noisy = render(texture, camera, (100, 100), bits=12, noise=10.0, seed=4)
    assert np.std(noisy.astype(float) - clean) == pytest.approx(10.0, rel=0.05)
    again = render(texture, camera, (100, 100), bits=12, noise=10.0, seed=4)
    np.testing.assert_array_equal(noisy, again)
    with pytest.raises(fedic.OptionError, match="bits=10"):
        render(texture, camera, (10, 10), bits=10)  # type: ignore[arg-type]


def test_progress_ends_at_one() -> None:
    states: list[fedic.Progress] = []
    render(Speckle(5.0), fedic.ImageFrame(), (300, 400), progress=states.append)
    done = [state.fraction for state in states]
    assert {state.stage for state in states} == {"render"}
    assert len(done) > 1
    assert done == sorted(done)
    assert done[-1] == 1.0


@pytest.mark.parametrize("level", [0.0, 20.0, 120.0, 3000.0])
@pytest.mark.parametrize(("noise", "shot_noise"), [(2.0, 0.0), (0.0, 0.05), (1.5, 0.4)])
def test_noise_has_the_given_mean_and_variance(level: float, noise: float, shot_noise: float) -> None:
    count = 400 * 500
    sample = add_noise(np.full((400, 500), level), noise=noise, shot_noise=shot_noise, seed=7).astype(np.float64)
    variance = noise**2 + shot_noise * level
    # Five standard deviations of the sample mean and variance, and the rounding of float32.
    assert abs(sample.mean() - level) <= 5.0 * np.sqrt(variance / count) + 1e-7 * level
    assert abs(sample.var() - variance) <= 5.0 * variance * np.sqrt(2.0 / count) + 1e-6


def test_noise_depends_on_pixel_and_seed_only() -> None:
    flat = np.full((200, 300), 100.0)
    sample = add_noise(flat, noise=1.0, seed=3) - flat
    np.testing.assert_array_equal(sample, add_noise(flat, noise=1.0, seed=3) - flat)
    other = add_noise(flat, noise=1.0, seed=4) - flat
    bound = 5.0 / np.sqrt(sample.size)
    for shifted in (other, np.roll(sample, 1, axis=0), np.roll(sample, 1, axis=1)):
        assert abs(np.mean(sample * shifted)) < bound


@pytest.mark.parametrize(("bits", "dtype"), [(8, np.uint8), (12, np.uint16), (16, np.uint16)])
def test_quantisation_rounds_and_clips(bits: int, dtype: type) -> None:
    full = 2**bits - 1
    levels = np.array([[-3.0, 0.4, 0.6, 99.4, full - 0.6, full - 0.4, full + 9.0]])
    image = add_noise(levels, bits=bits)  # type: ignore[call-overload]
    assert image.dtype == dtype
    np.testing.assert_array_equal(image, [[0, 0, 1, 99, full - 1, full, full]])


def test_add_noise_without_options_keeps_the_image() -> None:
    image = np.arange(12, dtype=np.uint16).reshape(3, 4)
    same = add_noise(image)
    assert same.dtype == np.float32
    np.testing.assert_array_equal(same, image)


def test_render_adds_the_noise_of_add_noise() -> None:
    texture, camera = Speckle(5.0, seed=1), fedic.ImageFrame()
    clean = render(texture, camera, (120, 150), bits=16).astype(np.float64)
    noisy = render(texture, camera, (120, 150), bits=16, noise=40.0, shot_noise=3.0, seed=5)
    assert np.abs(noisy - add_noise(clean, noise=40.0, shot_noise=3.0, seed=5)).max() < 1.1
    scaled = (noisy - clean) / np.sqrt(1600.0 + 3.0 * clean)
    assert np.std(scaled) == pytest.approx(1.0, abs=5.0 / np.sqrt(2.0 * scaled.size))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"noise": -1.0}, "noise=-1.0"),
        ({"shot_noise": -0.1}, "shot_noise=-0.1"),
        ({"noise": float("nan")}, "noise=nan"),
        ({"bits": 10}, "bits=10"),
    ],
)
def test_bad_noise_options_are_refused(options: dict[str, float], words: str) -> None:
    with pytest.raises(fedic.OptionError, match=f"add_noise: .*{words}"):
        add_noise(np.zeros((4, 4)), **options)  # type: ignore[call-overload]
    with pytest.raises(fedic.OptionError, match=f"render: .*{words}"):
        render(Speckle(5.0), fedic.ImageFrame(), (4, 4), **options)  # type: ignore[arg-type]


BORDER = 40


def inside(image: NDArray[np.float32]) -> NDArray[np.float32]:
    return image[BORDER:-BORDER, BORDER:-BORDER]


def band_limited(height: int, width: int, du: float = 0.0, dv: float = 0.0) -> Floats:
    """Waves of up to 0.35 periods per pixel, moved by (du, dv), under a bell that fades at the borders."""
    v, u = np.mgrid[:height, :width].astype(float) - np.array([dv, du]).reshape(2, 1, 1)
    random = np.random.default_rng(3)
    frequencies, phases = random.uniform(-0.35, 0.35, (12, 2)), random.uniform(0.0, 2.0 * np.pi, 12)
    waves = sum(np.cos(2.0 * np.pi * (a * u + b * v) + c) for (a, b), c in zip(frequencies, phases, strict=True))
    bell = np.exp(-(((u - width / 2) / (width / 9)) ** 2) - ((v - height / 2) / (height / 9)) ** 2)
    return np.asarray(120.0 + 9.0 * waves * bell)


@pytest.mark.parametrize("shift", [(0.5, 0.0), (-0.37, 1.62), (3.3, -7.9)])
@pytest.mark.parametrize("shape", [(150, 201), (181, 160)])
def test_fourier_shift_agrees_with_the_analytic_texture(shift: tuple[float, float], shape: tuple[int, int]) -> None:
    shifted = fourier_shift(band_limited(*shape), shift)
    assert shifted.dtype == np.float32
    assert np.abs(inside(shifted) - inside(band_limited(*shape, *shift))).max() < 1e-3


def test_fourier_shift_by_whole_pixels_rolls_the_image() -> None:
    image = render(Speckle(5.0, seed=6), fedic.ImageFrame(), (140, 171))
    shifted = fourier_shift(image, (7.0, -3.0))
    moved = np.roll(image, (-3, 7), axis=(0, 1))
    assert np.abs(shifted[:-3, 7:] - moved[:-3, 7:].astype(float)).max() < 1e-4
    np.testing.assert_allclose(shifted[:, 6], shifted[:, 7], atol=1e-4)
    np.testing.assert_allclose(fourier_shift(image, (0.0, 0.0)), image, atol=1e-4)


def test_opposite_fourier_shifts_cancel() -> None:
    ramp = np.linspace(0.0, 120.0, 171)
    image = render(Speckle(5.0, seed=6), fedic.ImageFrame(), (140, 171), levels=(0.1, 0.5)) + ramp
    back = fourier_shift(fourier_shift(image, (0.4, -2.3)), (-0.4, 2.3))
    # Values shifted out at the borders are lost; their effect decays with the distance.
    assert np.abs(inside(back) - inside(image)).max() < 0.1


@pytest.mark.parametrize(
    "image",
    [np.zeros(5), np.zeros((4, 4, 3)), np.zeros((0, 4)), np.full((3, 3), np.nan), np.zeros((3, 3), complex), None],
)
def test_bad_images_are_refused_by_shift_and_noise(image: NDArray[np.float64]) -> None:
    for change in (lambda: fourier_shift(image, (0.5, 0.5)), lambda: add_noise(image, noise=1.0)):
        with pytest.raises(fedic.ImageError, match="The given image"):
            change()


@pytest.mark.parametrize("shift", [(1.0,), (0.0, np.inf), (1.0, 2.0, 3.0)])
def test_bad_shifts_are_refused(shift: tuple[float, float]) -> None:
    with pytest.raises(fedic.OptionError, match=r"give a pair \(du, dv\)"):
        fourier_shift(np.zeros((4, 4)), shift)
