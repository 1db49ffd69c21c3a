"""Advice on the size of elements, against measured scatter and textures with known statistics."""

import json

import numpy as np
import pytest

import fedic
from fedic.advise.patches import cells_along
from fedic.advise.texture import speckle_size, texture_of
from scenes.static import scene, shot

SHAPE = (200, 220)
NOISE = 2.0


@pytest.fixture(scope="module")
def advice() -> fedic.Advice:
    return fedic.advise_element_size(shot(scene(SHAPE), 99), NOISE, sizes=(10.0, 16.0, 24.0))


@pytest.mark.parametrize("size", [10.0, 16.0, 24.0])
def test_predictions_agree_with_the_scatter_of_20_static_pairs(advice: fedic.Advice, size: float) -> None:
    count = int(180 // size)
    low, high = 15.0, 15.0 + count * size
    mesh = fedic.rectangle_mesh((low, low, high, high), size)
    displacement, strain = [], []
    for seed in range(20):
        pair = [shot(scene(SHAPE), 2 * seed + k) for k in range(2)]
        result = fedic.correlate(*pair, mesh, initial="zero")
        displacement.append(result.displacement)
        strain.append(result.strains("small").components)
    at_border = np.any((mesh.points[:, :2] < low + 1.0) | (mesh.points[:, :2] > high - 1.0), axis=1)
    inner_cells = ~np.any(at_border[mesh.cells["quad"]], axis=1)
    measured = np.sqrt((np.array(displacement)[:, ~at_border] ** 2).mean(axis=(0, 1)))
    measured_strain = np.sqrt((np.array(strain)[:, inner_cells] ** 2).mean(axis=(0, 1)))
    measured_border = np.sqrt((np.array(displacement)[:, at_border] ** 2).mean(axis=(0, 1)))
    index = list(advice.sizes).index(size)
    rms = lambda values: np.sqrt(np.mean(np.square(values)))  # noqa: E731
    assert rms(advice.displacement[index]) / rms(measured) == pytest.approx(1.0, abs=0.1)
    assert rms(advice.strain[index]) / rms(measured_strain) == pytest.approx(1.0, abs=0.1)
    assert rms(advice.border[index]) / rms(measured_border) == pytest.approx(1.0, abs=0.15)


def test_the_smallest_size_that_meets_the_targets_is_recommended() -> None:
    image = shot(scene(SHAPE), 1)
    free = fedic.advise_element_size(image, NOISE, sizes=(8.0, 12.0, 16.0, 24.0))
    good = (free.displacement <= 0.02).all(axis=1)
    assert free.recommended == free.sizes[good][0] == 12.0 or free.recommended == 16.0
    assert (np.diff(free.displacement, axis=0) < 0.0).all()
    strict = fedic.advise_element_size(image, NOISE, sizes=(8.0, 12.0, 16.0, 24.0), strain_target=5e-4)
    assert strict.recommended == 24.0
    assert (strict.strain[-1] <= 5e-4).all()
    assert (strict.strain[-2] > 5e-4).any()
    none = fedic.advise_element_size(image, NOISE, sizes=(8.0, 12.0), displacement_target=1e-4)
    assert np.isnan(none.recommended)
    assert "no size up to 12 px meets the targets" in none.doubts[0]


def test_predictions_are_proportional_to_the_noise_and_sizes_that_do_not_fit_are_left_out() -> None:
    image = scene(SHAPE).astype(np.float32)
    once, twice = (fedic.advise_element_size(image, noise, region=(20, 20, 120, 120)) for noise in (1.0, 2.0))
    np.testing.assert_allclose(twice.displacement, 2.0 * once.displacement, rtol=1e-9)
    np.testing.assert_allclose(twice.strain, 2.0 * once.strain, rtol=1e-9)
    assert list(once.sizes) == [8.0, 10.0, 12.0, 16.0, 20.0, 24.0, 32.0]


def test_options_and_cell_types_are_those_of_the_measurement() -> None:
    image = scene(SHAPE).astype(np.float32)
    found = fedic.advise_element_size(image, NOISE, sizes=[20.0], cell="triangle", smoothing=0.0)
    count = cells_along((0, 0, SHAPE[1], SHAPE[0]), 20.0)
    assert count == 8
    left, top = int(0.5 * (SHAPE[1] - 1 - 160)), int(0.5 * (SHAPE[0] - 1 - 160))
    mesh = fedic.rectangle_mesh((left, top, left + 160, top + 160), 20.0, "triangle")
    nodal = fedic.Correlator(image, mesh, smoothing=0.0).standard_deviations(NOISE)
    inner = np.all((mesh.points[:, :2] > (left, top)) & (mesh.points[:, :2] < (left + 160, top + 160)), axis=1)
    np.testing.assert_allclose(found.displacement[0], np.sqrt((nodal[inner] ** 2).mean(axis=0)), rtol=0.01)


@pytest.mark.parametrize("width", [3.0, 5.0, 9.0])
def test_the_speckle_size_is_the_width_of_the_autocorrelation(width: float) -> None:
    """White noise filtered by a Gaussian of deviation s has an autocorrelation 4 s sqrt(ln 2) wide at half maximum."""
    rng = np.random.default_rng(0)
    sigma = width / (4.0 * np.sqrt(np.log(2.0)))
    waves = [np.fft.fftfreq(512)[:, np.newaxis], np.fft.rfftfreq(512)]
    response = np.exp(-2.0 * (np.pi * sigma) ** 2 * (waves[0] ** 2 + waves[1] ** 2))
    field = np.fft.irfft2(np.fft.rfft2(rng.standard_normal((512, 512))) * response)
    grey = 128.0 + 30.0 * field / field.std() + np.linspace(-20.0, 20.0, 512) + rng.normal(0.0, 6.0, (512, 512))
    np.testing.assert_allclose(speckle_size(grey, 6.0), width, rtol=0.07)


def test_the_texture_has_the_statistics_of_the_image() -> None:
    u = np.tile(np.arange(256), (256, 1))
    wave = 100.0 + 40.0 * np.sin(2.0 * np.pi * u / 16.0)
    found = texture_of(fedic.synthetic.add_noise(wave, noise=4.0, seed=1), 4.0)
    assert found.contrast == pytest.approx(40.0 / np.sqrt(2.0), rel=0.01)
    assert found.gradient[0] == pytest.approx(40.0 * np.sin(2.0 * np.pi / 16.0) / np.sqrt(2.0), rel=0.01)
    assert found.gradient[1] < 0.5
    assert found.saturated_share == 0.0
    assert np.isnan(texture_of(shot(np.full((64, 64), 100.0), 1), NOISE).speckle_size).all()


def test_poor_images_are_doubted() -> None:
    sizes = (16.0, 24.0)
    saturated = shot(2.0 * scene(SHAPE), 1)
    assert any("saturated" in each for each in fedic.advise_element_size(saturated, NOISE, sizes=sizes).doubts)
    faint = shot(100.0 + 0.05 * scene(SHAPE), 1)
    assert any("times the noise" in each for each in fedic.advise_element_size(faint, NOISE, sizes=sizes).doubts)
    fine = shot(scene(SHAPE, size=2.0), 1)
    assert any("finer than 3 px" in each for each in fedic.advise_element_size(fine, NOISE, sizes=sizes).doubts)


def test_the_summary_is_json_and_the_figure_has_two_panels(advice: fedic.Advice) -> None:
    content = json.loads(json.dumps(advice.summary(), allow_nan=False))
    assert content["sizes_px"] == [10.0, 16.0, 24.0]
    assert content["recommended_px"] == advice.recommended
    assert len(advice.plot().axes) == 2
    assert "Advice(quad of" in repr(advice)


@pytest.mark.parametrize(
    ("arguments", "kind", "message"),
    [
        ({"noise": 0.0}, fedic.OptionError, "noise=0.0: give a positive number"),
        ({"noise": np.nan}, fedic.OptionError, "noise=nan"),
        ({"sizes": []}, fedic.OptionError, "sizes is empty"),
        ({"sizes": [-3.0]}, fedic.OptionError, "sizes=-3.0"),
        ({"sizes": [100.0]}, fedic.OptionError, "not even 3 elements of 100 px"),
        ({"cell": "hexagon"}, fedic.OptionError, "cell must be one of"),
        ({"region": (0, 0, 500, 100)}, fedic.OptionError, "within the image of 220 x 200 px"),
        ({"region": (0, 0, 20, 100)}, fedic.OptionError, "32 px or more"),
        ({"displacement_target": -1.0}, fedic.OptionError, "displacement_target=-1.0"),
        ({"smooting": 1.0}, fedic.OptionError, "did you mean smoothing"),
        ({"image": np.full((64, 64), 7, np.uint8)}, fedic.ImageError, "constant"),
        ({"image": np.zeros((64, 64, 3), np.uint8)}, fedic.ImageError, "give a grey image"),
    ],
)
def test_bad_input_is_refused(arguments: dict[str, object], kind: type[Exception], message: str) -> None:
    given: dict[str, object] = {"image": shot(scene(SHAPE), 1), "noise": NOISE, **arguments}
    with pytest.raises(kind, match=message):
        fedic.advise_element_size(**given)  # type: ignore[arg-type]
