"""Calibration: exact points, Monte Carlo, rendered targets, real images, and errors."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

import fedic
from fedic.calibration import calibrate_points, parse_target
from fedic.cli import app
from scenes.targets import CENTRE, FOCAL, SHAPE, Texture, poses

RUNNER = CliRunner()
BOARD = parse_target("chessboard:11x8:8")
SIZE = SHAPE[::-1]
LENSES = {
    "none": fedic.BrownDistortion(),
    "radial1": fedic.BrownDistortion((-0.15, 0.0, 0.0)),
    "brown": fedic.BrownDistortion((-0.15, 0.08, 0.05), (1e-3, -5e-4)),
    "radial2+prism": fedic.BrownDistortion((-0.15, 0.08, 0.0), prism=(8e-4, -6e-4)),
}


def true_parameters(lens: fedic.BrownDistortion) -> dict[str, float]:
    values = (*FOCAL, *CENTRE, *lens.radial, *lens.decentering, *lens.prism)
    return dict(zip(("fx", "fy", "cx", "cy", "k1", "k2", "k3", "d1", "d2", "p1", "p2"), values, strict=True))


def views(lens: str = "radial1", count: int = 12) -> list[NDArray[np.float64]]:
    return [camera.project(BOARD.points) for camera in poses(BOARD, count, LENSES[lens])]


def noisy(pixels: list[NDArray[np.float64]], seed: int, noise: float = 0.05) -> list[NDArray[np.float64]]:
    rng = np.random.default_rng(seed)
    return [each + rng.normal(0.0, noise, each.shape) for each in pixels]


def from_board(pixels: list[NDArray[np.float64]], distortion: str = "radial1") -> fedic.Calibration:
    return calibrate_points([BOARD.points] * len(pixels), pixels, SIZE, distortion)


@pytest.mark.parametrize("distortion", LENSES)
def test_exact_points_recover_the_camera(distortion: str) -> None:
    pixels = views(distortion)
    calibration = from_board(pixels, distortion)
    truth = true_parameters(LENSES[distortion])
    for name, value in calibration.parameters.items():
        assert value == pytest.approx(truth[name], rel=1e-6, abs=1e-7), name
    assert calibration.reprojection_error < 1e-6
    np.testing.assert_allclose(calibration.camera.project(BOARD.points), pixels[0], rtol=0, atol=1e-5)


@pytest.mark.parametrize("distortion", ["brown", "radial2+prism"])
def test_parameters_lie_within_their_standard_deviations(distortion: str) -> None:
    """Within three standard deviations in 47 of 50 draws, intrinsics and one pose; their scatter is one."""
    pixels, lens = views(distortion), LENSES[distortion]
    true_pose = poses(BOARD, 12, lens)[3]
    scores, pose_scores = [], []
    for draw in range(50):
        calibration = from_board(noisy(pixels, draw), distortion)
        truth, deviations = true_parameters(lens), np.array(list(calibration.standard_deviations.values()))
        errors = [value - truth[name] for name, value in calibration.parameters.items()]
        scores.append(np.array(errors) / deviations)
        place = len(deviations) + 6 * 3
        of_pose = np.sqrt(np.diag(calibration.covariance)[place : place + 6])
        turn = cv2.Rodrigues(calibration.views[3].rotation @ true_pose.rotation.T)[0].ravel()
        shift = calibration.views[3].translation - true_pose.translation
        pose_scores.append(np.concatenate([turn, shift]) / of_pose)
        assert all(view.accepted and view.used.all() for view in calibration.views)
    for each in (np.array(scores), np.array(pose_scores)):
        assert ((np.abs(each) < 3.0).sum(axis=0) >= 47).all()
        # The sample standard deviation of 50 draws is 1 +- 0.1; four of those.
        assert (np.abs(each.std(axis=0) - 1.0) < 0.4).all()


@pytest.mark.parametrize(
    ("distortion", "limit", "flags"),
    [
        ("radial1", 0.060, cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST),
        ("brown", 0.050, 0),
    ],
)
def test_real_chessboard_images(shared_data: Callable[[str], Path], distortion: str, limit: float, flags: int) -> None:
    images = sorted(shared_data("chessboard").glob("*.tif"))
    calibration = fedic.calibrate(images, "chessboard:11x7:8", distortion)
    assert len(calibration.views) == 20
    assert all(view.accepted for view in calibration.views)
    assert calibration.reprojection_error <= limit

    points = [view.points[view.used].astype(np.float32) for view in calibration.views]
    pixels = [view.pixels[view.used] for view in calibration.views]
    # OpenCV takes single precision: both programs are given the rounded points.
    rounded = [each.astype(np.float32) for each in pixels]
    ours = calibrate_points(points, rounded, calibration.image_size, distortion)
    assert all(view.used.all() for view in ours.views)
    error, matrix, lens, *_ = cv2.calibrateCamera(
        points, rounded, calibration.image_size, None, None, flags=flags, criteria=(3, 1000, 1e-15)
    )
    theirs = {"fx": matrix[0, 0], "fy": matrix[1, 1], "cx": matrix[0, 2], "cy": matrix[1, 2]}
    theirs |= dict(zip(("k1", "k2", "d1", "d2", "k3"), lens.ravel(), strict=False))
    assert ours.reprojection_error == pytest.approx(error, rel=1e-6)
    for name, value in ours.parameters.items():
        assert value == pytest.approx(theirs[name], rel=1e-6), name


@pytest.mark.parametrize(
    "text",
    ["chessboard:11x8:8", "circles:9x7:10", "asymmetric-circles:7x11:7", "charuco:12x9:8:6:DICT_5X5_100"],
)
def test_the_camera_is_recovered_from_rendered_targets(text: str) -> None:
    target, lens = parse_target(text), fedic.BrownDistortion((-0.15, 0.08, 0.0), (1e-3, -5e-4))
    cameras, texture = poses(target, 12, lens), Texture(target)
    images = [
        fedic.synthetic.render(texture, camera, SHAPE, noise=2.55, seed=view)  # type: ignore[arg-type]
        for view, camera in enumerate(cameras)
    ]
    calibration = fedic.calibrate(images, text, "radial2+decentering")
    assert all(view.accepted for view in calibration.views)
    assert calibration.reprojection_error <= 0.05
    grid = np.stack(np.meshgrid(np.linspace(0, SIZE[0] - 1, 20), np.linspace(0, SIZE[1] - 1, 15)), axis=-1).reshape(
        -1, 2
    )
    # Some targets are symmetric under half a turn.
    upside_down = np.diag([-1.0, -1.0, 1.0])
    span = target.points.max(axis=0) + target.points.min(axis=0)
    for camera, view in zip(cameras, calibration.views, strict=True):
        found = fedic.Pinhole(
            calibration.camera.focal,
            calibration.camera.principal_point,
            view.rotation,
            tuple(view.translation),
            distortion=calibration.camera.distortion,
        )
        points = camera.unproject(grid)
        errors = [
            np.linalg.norm(found.project(each) - grid, axis=1).max() for each in (points, points @ upside_down + span)
        ]
        assert min(errors) <= 0.05


def test_unprojection_agrees_with_opencv() -> None:
    lens = fedic.BrownDistortion((-0.2, 0.1, 0.02), (1e-3, -5e-4), (8e-4, -6e-4))
    camera = fedic.Pinhole(FOCAL, CENTRE, translation=(0.0, 0.0, 1.0), distortion=lens)
    grid = np.stack(np.meshgrid(np.linspace(0, 639, 33), np.linspace(0, 479, 25)), axis=-1).reshape(-1, 2)
    matrix = np.array([[FOCAL[0], 0, CENTRE[0]], [0, FOCAL[1], CENTRE[1]], [0, 0, 1]])
    (k1, k2, k3), (d1, d2), (p1, p2) = lens.radial, lens.decentering, lens.prism
    coefficients = np.array([k1, k2, d1, d2, k3, 0, 0, 0, p1, 0, p2, 0])
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)
    if hasattr(cv2, "undistortPointsIter"):  # until OpenCV 5
        straight = cv2.undistortPointsIter(grid[:, None], matrix, coefficients, None, matrix, criteria)
    else:
        straight = cv2.undistortPoints(grid[:, None], matrix, coefficients, None, None, matrix, criteria)
    ours = camera.unproject(grid)[:, :2] * FOCAL + CENTRE
    np.testing.assert_allclose(ours, straight[:, 0], rtol=0, atol=1e-6)


def test_a_light_target_on_a_dark_16_bit_image_is_found() -> None:
    target = parse_target("circles:9x7:10")
    cameras, texture = poses(target, 4, LENSES["radial1"]), Texture(target)
    images = [
        fedic.synthetic.render(texture, camera, SHAPE, levels=(0.6, 0.2), bits=16)  # type: ignore[arg-type]
        for camera in cameras
    ]
    calibration = fedic.calibrate(images, target)
    assert all(view.accepted for view in calibration.views)
    assert calibration.reprojection_error < 0.02


def test_bad_views_and_points_are_rejected() -> None:
    pixels = noisy(views(), 0)
    rng = np.random.default_rng(1)
    pixels[2] = np.roll(pixels[2], 3, axis=0)
    pixels[6][7] += 4.0
    pixels[8] += rng.normal(0.0, 0.5, pixels[8].shape)
    pixels[9][:30] += rng.normal(0.0, 2.0, (30, 2))
    calibration = from_board(pixels)
    rejected = {index: view.reason for index, view in enumerate(calibration.views) if not view.accepted}
    assert set(rejected) == {2, 8, 9}
    assert "px, more than 3 times the 0.0" in rejected[8]
    assert "of its 88 points are more than" in rejected[9]
    assert np.flatnonzero(~calibration.views[6].used).tolist() == [7]
    truth = true_parameters(LENSES["radial1"])
    for name, value in calibration.parameters.items():
        assert abs(value - truth[name]) < 4.0 * calibration.standard_deviations[name]


def test_the_pose_can_come_from_any_view() -> None:
    pixels = noisy(views(), 0)
    calibration = calibrate_points([BOARD.points] * 12, pixels, SIZE, view=5)
    assert calibration.view == 5
    offsets = calibration.camera.project(BOARD.points) - pixels[5]
    np.testing.assert_allclose(offsets, -calibration.views[5].residuals, atol=1e-9)
    with pytest.raises(fedic.OptionError, match=r"view 'x.tif': there is no such view; they are image 0"):
        calibrate_points([BOARD.points] * 12, pixels, SIZE, view="x.tif")


def parallel_views() -> list[NDArray[np.float64]]:
    facing = np.diag([1.0, -1.0, -1.0])
    return [
        fedic.Pinhole(
            FOCAL,
            CENTRE,
            cv2.Rodrigues(np.array([0.0, 0.0, 0.3 * view + 0.01]))[0] @ facing,
            (-30.0 + 5 * view, 20.0, 150.0 + 20 * view),
            distortion=LENSES["radial1"],
        ).project(BOARD.points)
        for view in range(8)
    ]


@pytest.mark.parametrize(
    ("pixels", "message"),
    [
        (noisy(views(), 0)[:1], "seen in 1 view, and the camera needs at least 2, better 10 to 20"),
        (noisy(parallel_views(), 0), "All views are parallel to within .* tilt the target by 20 to 40 degrees"),
        (
            [np.random.default_rng(view).uniform(0, 480, (88, 2)) for view in range(6)],
            "did not converge in 500 iterations: .* points found are not those of one flat target",
        ),
    ],
)
def test_insufficient_views_are_refused(pixels: list[NDArray[np.float64]], message: str) -> None:
    with pytest.raises(fedic.CameraError, match=message):
        from_board(pixels)


@pytest.mark.parametrize(
    ("pixels", "message"),
    [
        ([each[:, :1] for each in views()], r"image 0: points of shape \(88, 3\) and pixels of shape \(88, 1\)"),
        ([np.full((88, 2), np.nan)] * 3, "image 0: the points must be finite"),
    ],
)
def test_malformed_points_are_refused(pixels: list[NDArray[np.float64]], message: str) -> None:
    with pytest.raises(fedic.OptionError, match=message):
        from_board(pixels)


def test_collinear_points_are_refused() -> None:
    with pytest.raises(fedic.CameraError, match="The points of view number 0 are collinear"):
        calibrate_points([BOARD.points[:11]] * 4, [each[:11] for each in views()[:4]], SIZE)


def test_advice_names_what_is_missing() -> None:
    pixels = views(count=12)
    advice = " ".join(from_board(noisy(pixels[:3], 0), "radial3").advice)
    assert "Only 3 views are used: take 10 to 20." in advice
    assert "Not significantly different from zero: k" in advice
    assert "No point of the target is near the corner" in advice
    assert from_board(noisy(pixels, 0)).advice == []
    assert "and p2 can hardly be told apart (correlation 0.99" in " ".join(
        from_board(noisy(pixels, 0), "brown+prism").advice
    )
    facing = np.diag([1.0, -1.0, -1.0])
    one_axis = [
        fedic.Pinhole(FOCAL, CENTRE, cv2.Rodrigues(np.array([0.3 * np.sin(k), 0, 0]))[0] @ facing, (-30.0, 20.0, 150.0))
        for k in range(8)
    ]
    advice = " ".join(from_board(noisy([each.project(BOARD.points) for each in one_axis], 0)).advice)
    assert "tilted about one axis only (by 3" in advice


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder of five small views of a chessboard."""
    target = parse_target("chessboard:7x5:12")
    for index, camera in enumerate(poses(target, 5, LENSES["radial1"])):
        image = fedic.synthetic.render(Texture(target), camera, SHAPE, supersampling=1)  # type: ignore[arg-type]
        assert cv2.imwrite(str(tmp_path / f"view-{index}.png"), image)
    return tmp_path


def test_unusable_images_are_reported_with_the_reason(folder: Path) -> None:
    blank = np.full(SHAPE, 128, dtype=np.uint8)
    assert cv2.imwrite(str(folder / "view-5.png"), blank)
    (folder / "view-6.png").write_bytes(b"")
    assert cv2.imwrite(str(folder / "view-7.png"), blank[:100])
    board = cv2.imread(str(folder / "view-0.png"), cv2.IMREAD_GRAYSCALE)
    assert cv2.imwrite(str(folder / "view-8.png"), np.pad(board, 10, constant_values=230))
    calibration = fedic.calibrate(str(folder / "view-*.png"), "chessboard:7x5:12")
    reasons = [view.reason for view in calibration.views]
    assert reasons[:5] == [""] * 5
    assert reasons[5] == "no complete chessboard of 7 x 5 inner corners is found"
    assert reasons[6] == "the image file is empty (0 bytes)."
    assert reasons[7] == "no complete chessboard of 7 x 5 inner corners is found"
    assert reasons[8] == "the image is 660 x 500 px, most are 640 x 480: another camera"

    with pytest.raises(fedic.CameraError, match=r"(?s)found in 0 of 5 images.*view-0.png: a chessboard of 7 x 5 inner"):
        fedic.calibrate([folder / f"view-{index}.png" for index in range(5)], "chessboard:8x6:12")
    with pytest.raises(fedic.CameraError, match="found in 1 of 1 images; a calibration needs at least 2"):
        fedic.calibrate([folder / "view-0.png"], "chessboard:7x5:12")
    with pytest.raises(fedic.CameraError, match="circles is found; "):
        fedic.calibrate(str(folder / "view-0.png"), "circles:7x5:12")
    with pytest.raises(fedic.CameraError, match="0 corners of the board are found"):
        fedic.calibrate(str(folder / "view-0.png"), "charuco:7x5:12:8:DICT_4X4_50")
    with pytest.raises(fedic.ImageError, match="no image file matches"):
        fedic.calibrate(str(folder / "*.tif"), "chessboard:7x5:12")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("chess:11x7:8", "'chess' is unknown; give one of"),
        ("chessboard:11x7", "should be written chessboard:COLUMNSxROWS:SQUARE"),
        ("chessboard:11:8", "should be written chessboard:COLUMNSxROWS:SQUARE"),
        ("chessboard:11x7:eight", "should be written chessboard:COLUMNSxROWS:SQUARE"),
        ("chessboard:1x7:8", "1 x 7 is too small"),
        ("circles:4x4:-1", "lengths must be positive"),
        ("charuco:5x7:8:9:DICT_4X4_50", r"a marker \(9\) must be smaller than its square \(8\)"),
        ("charuco:5x7:8:6:DICT_4X4", "'DICT_4X4' is not a dictionary of markers; OpenCV has DICT_4X4_100"),
    ],
)
def test_misspelt_targets_are_refused(text: str, message: str) -> None:
    with pytest.raises(fedic.OptionError, match=message):
        parse_target(text)


@pytest.mark.parametrize("distortion", ["radial4", "radial1+", ["radial1", "tilt"], [], "fisheye"])
def test_misspelt_distortions_are_refused(distortion: str | list[str]) -> None:
    with pytest.raises(fedic.OptionError, match="is unknown; give one of none, radial1"):
        calibrate_points([BOARD.points], [BOARD.points[:, :2]], SIZE, distortion)


def test_the_command_line_calibrates(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    images = [f"view-{index}.png" for index in range(5)]
    arguments = ["calibrate", *images, "--target", "chessboard:7x5:12", "--picture", "residuals.png"]
    outcome = RUNNER.invoke(app, arguments)
    assert outcome.exit_code == 0, outcome.output
    for text in (
        "view-4.png",
        "35/35",
        "fx",
        "standard deviation",
        "Only 5 views are used",
        "Camera written to camera.toml",
    ):
        assert text in outcome.stdout
    assert cv2.imread("residuals.png") is not None
    assert isinstance(fedic.read_camera("camera.toml"), fedic.Pinhole)

    before = Path("camera.toml").read_text()
    outcome = RUNNER.invoke(app, arguments)
    assert outcome.exit_code == 2
    assert "camera.toml: this camera file exists and was not changed" in outcome.stderr
    assert Path("camera.toml").read_text() == before
    outcome = RUNNER.invoke(app, [*arguments, "--overwrite", "--view", "view-2.png"])
    assert outcome.exit_code == 0, outcome.output
    assert "Camera replaced in camera.toml" in outcome.stdout
    for name, fault in (
        ("no/camera.toml", "the folder no does not exist"),
        ("camera.json", "cannot be written as '.json'"),
    ):
        outcome = RUNNER.invoke(app, [*arguments, "--output", name])
        assert outcome.exit_code == 2
        assert fault in outcome.stderr
    outcome = RUNNER.invoke(
        app, ["calibrate", *images, "--target", "chessboard:7x5:12", "--output", "b.toml", "--picture", "a.bmp"]
    )
    assert "a.bmp: pictures are written as .png" in outcome.stderr
    assert 'pose_of = "view-2.png"' in Path("camera.toml").read_text()
