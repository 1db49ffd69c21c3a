"""The noise of a camera from static images, against noise that is known."""

import json
import warnings

import numpy as np
import pytest
from matplotlib.axes import Axes

import fedic
from fedic._core import full_scale
from fedic._internal.saturation import saturated_share
from fedic.noise._gradient import MARGIN, gradient
from fedic.noise._grey_line import fit_grey_line
from scenes.static import scene, shot

ROUNDING = 1.0 / 12.0
SEEDS = range(20)


def noise_of(*images: np.ndarray) -> fedic.CameraNoise:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fedic.QualityWarning)
        return fedic.camera_noise(images)


def moved(displacement: object) -> np.ndarray:
    texture = fedic.synthetic.Speckle(5.0, seed=3)
    image = fedic.synthetic.render(texture, fedic.ImageFrame(), (300, 300), displacement=displacement, bits=16)  # type: ignore[arg-type]
    return np.asarray(image / 257.0)


def test_static_pairs_give_the_noise_and_no_alarm() -> None:
    true = np.sqrt(4.0 + ROUNDING)
    found = [noise_of(shot(scene(), 2 * seed), shot(scene(), 2 * seed + 1)) for seed in SEEDS]
    ratios = np.array([each.std for each in found]) / true
    assert np.abs(ratios - 1.0).max() < 0.01
    assert [each.doubts for each in found if each.moved or each.doubts] == []
    # The standard errors are those of the scatter.
    assert np.std(ratios, ddof=1) * true == pytest.approx(found[0].standard_error, rel=0.5)
    shifts = np.array([each.shift[0] for each in found])
    assert np.std(shifts) == pytest.approx(found[0].shift_error.mean(), rel=0.5)


def test_a_change_of_the_light_by_five_percent_is_no_noise_and_no_motion() -> None:
    for seed in SEEDS[:10]:
        found = noise_of(shot(scene(), 2 * seed), shot(scene(), 2 * seed + 1, gain=0.95))
        assert found.std == pytest.approx(np.sqrt(4.0 + ROUNDING), rel=0.01)
        assert not found.moved
        assert not found.doubts


def test_light_that_tilts_over_the_image_is_no_noise() -> None:
    tilt = 1.0 + 0.1 * np.linspace(-1.0, 1.0, 300)
    found = noise_of(shot(scene(), 1), shot(scene() * tilt, 2))
    assert found.std == pytest.approx(np.sqrt(4.0 + ROUNDING), rel=0.01)
    assert not found.moved


@pytest.mark.parametrize("noise", [0.5, 1.0, 4.0])
def test_any_noise_is_found_within_one_percent(noise: float) -> None:
    images = [shot(scene(), seed, noise=noise) for seed in range(3)]
    found = noise_of(*images)
    assert found.std == pytest.approx(np.sqrt(noise**2 + ROUNDING), rel=0.01)
    assert found.num_images == 3
    assert found.shift.shape == (2, 2)


def test_the_variance_against_the_grey_level_gives_slope_and_intercept() -> None:
    images = [shot(scene((400, 500)), seed, noise=1.0, shot_noise=0.04) for seed in range(4)]
    found = fedic.camera_noise(images)
    assert found.slope == pytest.approx(0.04, rel=0.03)
    assert found.intercept == pytest.approx(1.0 + ROUNDING, rel=0.08)
    assert abs(found.slope - 0.04) < 4.0 * found.slope_error
    assert len(found.greys) == 20
    assert found.at(150.0) == pytest.approx(np.sqrt(1.0 + ROUNDING + 0.04 * 150.0), rel=0.01)
    assert np.isnan(found.at(-1e6))


@pytest.mark.parametrize("shift", [(0.05, 0.0), (0.0, -0.05), (0.03, 0.04), (0.1, 0.0)])
def test_images_that_moved_are_recognised_and_the_noise_corrected(shift: tuple[float, float]) -> None:
    with pytest.warns(fedic.QualityWarning, match=r"the images moved by 0\.\d+ px: the noise reads \d+% too high"):
        found = fedic.camera_noise([shot(scene(), 1), shot(scene(shift=shift), 2)])
    true = np.sqrt(4.0 + ROUNDING)
    assert found.moved
    np.testing.assert_allclose(found.shift[0], shift, atol=0.003)
    assert found.raw_std > 1.05 * true
    assert found.raw_std / found.std - 1.0 == pytest.approx(found.excess[0], abs=0.02)
    assert found.std == pytest.approx(true, rel=0.02)


def test_a_rotation_without_translation_is_recognised() -> None:
    angle = np.deg2rad(0.03)

    def turn(points: np.ndarray) -> np.ndarray:
        centred = points[:, :2] - 149.5
        rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        return centred @ rotation.T - centred

    found = noise_of(shot(scene(), 1), shot(moved(turn), 2))
    assert np.abs(found.shift).max() < 0.01
    assert found.moved
    assert found.motion[0] == pytest.approx(angle * np.sqrt(2.0 * 300**2 / 12.0), rel=0.1)
    assert found.std == pytest.approx(np.sqrt(4.0 + ROUNDING), rel=0.02)


@pytest.mark.parametrize("shift", [(0.5, 0.0), (3.0, -7.0)])
def test_a_motion_that_is_too_large_gives_no_noise(shift: tuple[float, float]) -> None:
    found = noise_of(shot(scene(), 1), shot(scene(shift=shift), 2))
    assert found.moved
    assert found.refused_pairs == 1
    assert np.isnan([found.std, found.slope, found.excess[0]]).all()
    np.testing.assert_allclose(found.shift[0], shift, atol=0.05)
    assert "take the images again" in found.doubts[0]


def test_one_image_that_moved_among_others_is_left_out() -> None:
    images = [shot(scene(), seed) for seed in range(3)]
    found = noise_of(*images, shot(scene(shift=(2.0, 0.0)), 5))
    assert found.refused_pairs == 1
    assert found.std == pytest.approx(np.sqrt(4.0 + ROUNDING), rel=0.01)
    assert "1 of 3 pairs of images moved by 2 px" in found.doubts[0]


def test_a_slow_drift_of_light_and_position_is_no_noise() -> None:
    images = [shot(scene(shift=(0.005 * k, 0.0)), k, gain=1.0 + 0.01 * k) for k in range(6)]
    found = noise_of(*images)
    assert found.std == pytest.approx(np.sqrt(4.0 + ROUNDING), rel=0.01)
    assert not found.moved
    assert found.shift[:, 0].mean() == pytest.approx(0.005, abs=0.001)


def test_another_scene_gives_no_noise() -> None:
    found = noise_of(shot(scene(), 1), shot(scene()[::-1], 2))
    assert np.isnan(found.std)
    assert found.refused_pairs == 1


def test_a_change_in_a_part_of_the_image_is_noticed() -> None:
    changed = scene().copy()
    changed[40:120, 60:200] = scene()[160:240, 60:200]
    found = noise_of(shot(scene(), 1), shot(changed, 2))
    assert found.doubts
    assert np.isnan(found.std) or "something changed there" in " ".join(found.doubts)


def test_a_plain_grey_card_has_a_noise_but_no_line() -> None:
    card = np.full((200, 240), 120.0)
    found = fedic.camera_noise([shot(card, 1), shot(card, 2)])
    assert found.std == pytest.approx(np.sqrt(4.0 + ROUNDING), rel=0.015)
    assert np.isnan([found.slope, found.intercept]).all()
    assert not found.moved


def test_saturated_and_black_pixels_are_left_out() -> None:
    bright = 1.5 * scene() - 60.0
    found = fedic.camera_noise([shot(bright, 1), shot(bright, 2)])
    assert found.std == pytest.approx(np.sqrt(4.0 + ROUNDING), rel=0.015)
    assert 0.5 < found.used_share < 0.95
    assert found.saturated_share == pytest.approx(np.mean(shot(bright, 1) == 255), rel=0.05)


def test_correlated_noise_is_said() -> None:
    rng = np.random.default_rng(1)

    def taken() -> np.ndarray:
        noise = rng.normal(0.0, 3.0, (300, 301))
        smooth = (noise[:, :-1] + noise[:, 1:]) / 2.0
        return np.rint(scene() + smooth).astype(np.uint8)

    with pytest.warns(fedic.QualityWarning, match="neighbouring pixels is correlated"):
        found = fedic.camera_noise([taken(), taken()])
    assert found.correlation[0] == pytest.approx(0.5, abs=0.05)
    assert abs(found.correlation[1]) < 0.05


def test_noise_below_the_rounding_is_said() -> None:
    found = noise_of(shot(scene(), 1, noise=0.1), shot(scene(), 2, noise=0.1))
    assert "hidden by their rounding" in found.doubts[0]


@pytest.mark.parametrize("depth", [np.uint16, np.float32])
def test_other_depths_give_the_same_noise_in_their_own_levels(depth: type) -> None:
    factor = 16.0
    images = [
        np.rint(factor * scene() + np.random.default_rng(seed).normal(0.0, 8.0, (300, 300))).astype(depth)
        for seed in (1, 2)
    ]
    assert fedic.camera_noise(images).std == pytest.approx(np.sqrt(64.0 + ROUNDING), rel=0.01)


def test_the_summary_is_json_and_the_plot_returns_axes() -> None:
    found = fedic.camera_noise([shot(scene(), seed) for seed in (1, 2)])
    summary = json.loads(json.dumps(found.summary(), allow_nan=False))
    assert summary["std"] == found.std
    assert summary["num_images"] == 2
    axes = found.plot()
    assert isinstance(axes, Axes)
    assert found.plot(axes) is axes
    assert "grey levels from 2 images" in repr(found)
    refused = noise_of(shot(scene(), 1), shot(scene(shift=(3.0, 0.0)), 2))
    json.dumps(refused.summary(), allow_nan=False)
    assert isinstance(refused.plot(), Axes)


def test_bad_images_are_refused() -> None:
    image, other = shot(scene(), 1), shot(scene(), 2)
    dark, bright = np.zeros((64, 64), np.uint8), np.full((64, 64), 255, np.uint8)
    bright_pair = [bright.copy(), bright.copy()]
    bright_pair[0][0, :5], bright_pair[1][0, :7] = 250, 251
    cases: list[tuple[list[object], type[fedic.FedicError], str]] = [
        ([image], fedic.OptionError, "1 image was given"),
        ([], fedic.OptionError, "0 image was given"),
        ([image, other[:200]], fedic.ImageError, "300 x 200 px"),
        ([image, other.astype(np.uint16)], fedic.ImageError, "of uint16"),
        ([np.dstack([image] * 3), np.dstack([other] * 3)], fedic.ImageError, "give a grey image"),
        ([image, image.copy()], fedic.ImageError, "equals the one before"),
        ([dark, dark + 1], fedic.ImageError, "is constant"),
        ([bright, bright], fedic.ImageError, "is constant"),
        (bright_pair, fedic.ImageError, "change the exposure"),
        ([image[:20], other[:20]], fedic.ImageError, "at least 32 px"),
        ([scene() * np.nan, scene()], fedic.ImageError, "NaN"),
    ]
    for images, kind, message in cases:
        with pytest.raises(kind, match=message):
            fedic.camera_noise(images)  # type: ignore[arg-type]
    with pytest.raises(fedic.OptionError, match="images is one image"):
        fedic.camera_noise(image)  # type: ignore[arg-type]


def test_the_gradient_is_exact_for_polynomials_of_sixth_degree() -> None:
    v, u = np.mgrid[:30, :40] / 10.0
    along_u, along_v = gradient(u**6 - 2.0 * u * v**5)
    inner = np.s_[MARGIN:-MARGIN, MARGIN:-MARGIN]
    np.testing.assert_allclose(along_u, 0.1 * (6.0 * u**5 - 2.0 * v**5)[inner], atol=1e-9)
    np.testing.assert_allclose(along_v, 0.1 * (-10.0 * u * v**4)[inner], atol=1e-9)


def test_a_line_through_exact_variances_is_exact() -> None:
    grey = np.linspace(20.0, 220.0, 4000)
    rng = np.random.default_rng(0)
    variance = 1.5 + 0.03 * grey
    line = fit_grey_line(
        grey, variance * (1.0 + rng.choice([-0.5, 0.5], 4000)[rng.permutation(4000)] * 0.0 + 1e-9 * grey)
    )
    assert line.slope == pytest.approx(0.03, rel=1e-5)
    assert line.intercept == pytest.approx(1.5, rel=1e-5)


@pytest.mark.parametrize(
    ("dtype", "largest"),
    [
        (np.uint8, 255),
        (np.uint8, 254),
        (np.uint16, 1023),
        (np.uint16, 65520),
        (np.uint16, 1000),
        (np.float32, 1.0),
        (np.float32, 254.5),
    ],
)
def test_full_scales_are_those_of_the_core(dtype: type, largest: float) -> None:
    mesh = fedic.rectangle_mesh((8, 8, 40, 40), size=16)
    core = fedic.Correlator(shot(scene((64, 64)), 1), mesh)._core
    for count in (8, 9, 200):
        image = np.full((64, 64), 0.1 if largest == 1.0 else 3).astype(dtype)
        image.ravel()[:count] = largest
        assert saturated_share(image) == core.saturated_share(image, (0, 0), (64, 64))
        assert (full_scale(image) is None) == (saturated_share(image) == 0.0)
