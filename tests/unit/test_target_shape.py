"""Targets that are not as planned: stretched, skewed, bent, with wrong counts of points."""

import warnings

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.calibration import Calibration, Target, calibrate_points, parse_target
from scenes.targets import CENTRE, FOCAL, SHAPE, Texture, poses

LENS = fedic.BrownDistortion((-0.15, 0.0, 0.0))
BOARD = Target("chessboard", 11, 8, 8.0)
TRUTH = {"fx": FOCAL[0], "fy": FOCAL[1], "cx": CENTRE[0], "cy": CENTRE[1], "k1": -0.15}
CAMERAS = poses(BOARD, 12, LENS)

Points = NDArray[np.float64]


def seen(points: Points, noise: float, seed: int) -> list[Points]:
    rng = np.random.default_rng(seed)
    return [camera.project(points) + rng.normal(0.0, noise, (len(points), 2)) for camera in CAMERAS]


def calibrated(points: Points, noise: float = 0.03, seed: int = 0, plan: Target = BOARD) -> Calibration:
    return calibrate_points([plan.points] * len(CAMERAS), seen(points, noise, seed), SHAPE[::-1])


def worst(calibration: Calibration) -> float:
    """Return the largest error of a parameter, in standard deviations."""
    pairs = calibration.parameters.items()
    return max(abs(value - TRUTH[name]) / calibration.standard_deviations[name] for name, value in pairs)


@pytest.mark.parametrize("stretch", [-0.02, -0.005, 0.005, 0.01, 0.02])
@pytest.mark.parametrize("noise", [0.02, 0.1])
def test_a_stretch_is_found_and_the_camera_is_right(stretch: float, noise: float) -> None:
    points = BOARD.points * [1.0, 1.0 + stretch, 1.0]
    with pytest.warns(fedic.CalibrationWarning, match=r"pitch along Y .* is .* ± .* such as chessboard:11x7:8x8.04"):
        calibration = calibrated(points, noise)
    value, deviation = calibration.target_shape["stretch"]
    assert abs(value - stretch) < 3.5 * deviation
    assert worst(calibration) < 3.5
    assert list(calibration.parameters) == list(TRUTH)
    assert len(calibration.covariance) == 5 + 6 * 12
    np.testing.assert_allclose(calibration.views[0].points, points, rtol=0, atol=0.05)


def test_two_pitches_need_no_warning() -> None:
    plan = Target("chessboard", 11, 8, (8.0, 8.08))
    calibration = calibrated(BOARD.points * [1.0, 1.01, 1.0], plan=plan)
    assert calibration.target_shape == {}
    assert worst(calibration) < 3.5


def test_a_skew_is_found() -> None:
    points = BOARD.points.copy()
    points[:, 0] += 0.01 * points[:, 1]
    with pytest.warns(fedic.CalibrationWarning, match="not right-angled: its columns lean by .* mrad"):
        calibration = calibrated(points)
    value, deviation = calibration.target_shape["skew"]
    assert abs(value - 0.01) < 3.5 * deviation
    assert worst(calibration) < 3.5


@pytest.mark.parametrize("rise", [0.1, 0.5])
def test_a_bend_is_found(rise: float) -> None:
    points = BOARD.points.copy()
    x = (points[:, 0] - points[:, 0].mean()) / np.ptp(points[:, 0]) * 2.0
    points[:, 2] = rise * x**2
    with pytest.warns(fedic.CalibrationWarning, match="not flat: over half its length it rises by"):
        calibration = calibrated(points)
    assert "bend_xx" in calibration.target_shape
    assert worst(calibration) < 3.5


def test_flat_square_targets_are_left_as_they_are() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert all(calibrated(BOARD.points, 0.05, seed).target_shape == {} for seed in range(8))


def test_a_shape_that_is_not_modelled_enlarges_the_standard_deviations() -> None:
    """Waves of 0.1 mm: the residuals of neighbours are correlated, and the errors are larger than their scatter."""
    points = BOARD.points.copy()
    points[:, 2] = 0.15 * np.sin(2.0 * np.pi * points[:, 0] / 45.0) * np.cos(2.0 * np.pi * points[:, 1] / 45.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fedic.CalibrationWarning)
        calibration = calibrated(points, 0.01)
    flat = calibrated(BOARD.points, 0.01)
    grown = calibration.standard_deviations["fx"] / flat.standard_deviations["fx"]
    assert grown > 2.0 * calibration.reprojection_error / flat.reprojection_error
    assert worst(calibration) < 4.0


def test_a_misfit_of_pixels_is_refused() -> None:
    """A point in three is one square off, alternately, so that no view stands out."""
    plan, points = BOARD.points, BOARD.points.copy()
    points[::3, 0] += 4.0
    with pytest.raises(fedic.CameraError, match=r"points are .* px off .*, more than 2 px: no camera with this lens"):
        calibrate_points([plan] * 12, seen(points, 0.02, 0), SHAPE[::-1])


def test_focal_lengths_that_no_camera_has_are_refused() -> None:
    pixels = [each * [1.0, 2.0] for each in seen(BOARD.points, 0.02, 0)]
    with pytest.raises(fedic.CameraError, match=r"differ by the factor 2.01: that is no camera"):
        calibrate_points([BOARD.points] * 12, pixels, (SHAPE[1], 2 * SHAPE[0]))


def test_pixels_that_are_not_square_are_said() -> None:
    pixels = [each * [1.0, 1.05] for each in seen(BOARD.points, 0.02, 0)]
    with pytest.warns(fedic.CalibrationWarning, match=r"differ by 5.6 %. If the pixels of the camera are square"):
        calibrate_points([BOARD.points] * 12, pixels, (SHAPE[1], int(1.05 * SHAPE[0])))


def test_two_pitches_are_read_and_written() -> None:
    target = parse_target("circles:9x7:10x10.05")
    assert target.pitches == (10.0, 10.05)
    assert str(target) == "circles:9x7:10x10.05"
    assert str(parse_target("circles:9x7:10x10")) == "circles:9x7:10"
    np.testing.assert_allclose(target.points[0], [0.0, 6 * 10.05, 0.0])
    assert str(parse_target("charuco:12x8:10x10.1:7:DICT_5X5_100")) == "charuco:12x8:10x10.1:7:DICT_5X5_100"
    for text in ("circles:9x7:10x", "circles:9x7:10x10x10", "circles:9x7:10x-1", "charuco:5x7:10x8:9:DICT_4X4_50"):
        with pytest.raises(fedic.OptionError):
            parse_target(text)


class Stretched:
    """A texture whose print is stretched along Y."""

    def __init__(self, target: Target, stretch: float) -> None:
        self._texture, self._stretch = Texture(target), stretch

    def values(self, points: Points) -> Points:
        return self._texture.values(np.asarray(points)[:, :2] / [1.0, 1.0 + self._stretch])


def test_a_stretched_print_is_found_in_images() -> None:
    target = Target("chessboard", 7, 5, 12.0)
    images = [
        fedic.synthetic.render(Stretched(target, 0.01), camera, SHAPE, noise=2.0, seed=view)  # type: ignore[arg-type]
        for view, camera in enumerate(poses(target, 5, LENS))
    ]
    with pytest.warns(fedic.CalibrationWarning, match="pitch along Y"):
        calibration = fedic.calibrate(images, target)
    value, deviation = calibration.target_shape["stretch"]
    assert abs(value - 0.01) < 4.0 * deviation + 2e-4
    calibration = fedic.calibrate(images, "chessboard:7x5:12x12.12")
    assert calibration.target_shape == {}
