"""Camera files: round trips, files of other programs, errors that name the file and the key."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.campaign.config import load_config

VECTOR = np.array([3.0, 0.2, -0.1])
LENS = fedic.BrownDistortion((-0.1, 0.2, 0.05), (1e-3, -5e-4), (8e-4, -6e-4))
CAMERA = fedic.Pinhole((900.1, 905.2), (325.3, 236.4), VECTOR, (1.5, -2.5, 100.0), distortion=LENS)
MATRIX = np.array([[900.1, 0, 325.3], [0, 905.2, 236.4], [0, 0, 1]])
POINTS = np.array([[0.0, 0.0, 0.0], [20.0, 5.0, 0.0], [-10.0, 15.0, 3.0]])


def same(found: Any, expected: Any) -> None:
    np.testing.assert_allclose(found.project(POINTS), expected.project(POINTS), rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    "camera",
    [
        CAMERA,
        fedic.Pinhole((900, 905), (325, 236), VECTOR, (1, 2, 100)),
        fedic.Pinhole((900, 905), (325, 236), VECTOR, (1, 2, 100), 1.5, LENS),
        fedic.FrontParallel(12.5, (3.0, 400.0)),
        fedic.FrontParallel(12.5, (3.0, 400.0), -0.7),
        fedic.ImageFrame(),
    ],
)
def test_toml_files_preserve_the_camera(camera: Any, tmp_path: Path) -> None:
    path = fedic.write_camera(camera, tmp_path / "camera.toml")
    found = fedic.read_camera(path)
    assert type(found) is type(camera)
    np.testing.assert_allclose(found.project(POINTS), camera.project(POINTS), rtol=1e-15, atol=1e-12)


@pytest.mark.parametrize("suffix", [".yml", ".yaml", ".xml"])
@pytest.mark.parametrize("lens", [None, fedic.BrownDistortion((-0.1, 0.2, 0.05), (1e-3, -5e-4)), LENS])
def test_opencv_files_preserve_the_camera(lens: Any, suffix: str, tmp_path: Path) -> None:
    camera = fedic.Pinhole((900.1, 905.2), (325.3, 236.4), VECTOR, (1.5, -2.5, 100.0), distortion=lens)
    path = fedic.write_camera(camera, tmp_path / f"camera{suffix}")
    same(fedic.read_camera(path), camera)
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    matrix, coefficients = storage.getNode("camera_matrix").mat(), storage.getNode("distortion_coefficients").mat()
    pose = storage.getNode("rvec").mat(), storage.getNode("tvec").mat()
    expected = cv2.projectPoints(POINTS, *pose, matrix, coefficients)[0][:, 0]
    np.testing.assert_allclose(camera.project(POINTS), expected, rtol=0, atol=1e-9)


def test_an_existing_camera_file_is_kept_without_overwrite(tmp_path: Path) -> None:
    path = tmp_path / "camera.toml"
    fedic.write_camera(CAMERA, path)
    before = path.read_bytes()
    with pytest.raises(fedic.CameraError, match=r"camera.toml: this camera file exists .* overwrite=True"):
        fedic.write_camera(fedic.ImageFrame(), path)
    assert path.read_bytes() == before
    fedic.write_camera(fedic.ImageFrame(), path, overwrite=True)
    assert isinstance(fedic.read_camera(path), fedic.ImageFrame)
    assert [each.name for each in tmp_path.iterdir()] == ["camera.toml"]


@pytest.mark.parametrize(
    ("camera", "name", "message"),
    [
        (fedic.ImageFrame(), "camera.yml", "can hold a Pinhole only, not a ImageFrame; write"),
        (fedic.Pinhole((9, 9), (0, 0), skew_angle=1.5), "camera.xml", "OpenCV ignores the skew"),
    ],
)
def test_cameras_that_a_format_cannot_hold_are_refused(camera: Any, name: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(fedic.CameraError, match=message):
        fedic.write_camera(camera, tmp_path / name)
    with pytest.raises(fedic.OptionError, match=r"cannot be written as '.json'; give \.toml, \.yml"):
        fedic.write_camera(camera, tmp_path / "camera.json")
    with pytest.raises(fedic.FedicError, match=r"the folder .* does not exist"):
        fedic.write_camera(CAMERA, tmp_path / "no" / "camera.yml")


@pytest.mark.parametrize(
    ("matrix", "lens"),
    [("camera_matrix", "distortion_coefficients"), ("mtx", "dist"), ("K", "D"), ("cameraMatrix", "distCoeffs")],
)
@pytest.mark.parametrize("suffix", [".yml", ".xml", ".npz"])
def test_common_key_names_are_recognised(matrix: str, lens: str, suffix: str, tmp_path: Path) -> None:
    arrays = {
        matrix: MATRIX,
        lens: np.array([[-0.1, 0.2, 1e-3, -5e-4, 0.05, 0, 0, 0, 8e-4, 0, -6e-4, 0]]),
        "rvec": VECTOR.reshape(3, 1),
        "tvec": np.array([1.5, -2.5, 100.0]),
    }
    path = tmp_path / f"other{suffix}"
    if suffix == ".npz":
        np.savez(path, **arrays)
    else:
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        for key, values in arrays.items():
            storage.write(key, np.atleast_2d(values))
        storage.release()
    same(fedic.read_camera(path), CAMERA)


def test_a_camera_matrix_with_skew_and_no_pose_is_read(tmp_path: Path) -> None:
    matrix = MATRIX.copy()
    matrix[0, 1] = 30.0
    np.savez(tmp_path / "k.npz", K=matrix)
    camera = fedic.read_camera(tmp_path / "k.npz")
    assert isinstance(camera, fedic.Pinhole)
    assert camera.distortion is None
    point = np.array([0.3, -0.2, 1.0])
    np.testing.assert_allclose(camera.project([point])[0], (matrix @ point)[:2], rtol=1e-14)


def test_ros_yaml_is_read(tmp_path: Path) -> None:
    text = """\
image_width: 640
image_height: 480
camera_name: left
camera_matrix:
  rows: 3
  cols: 3
  data: [900.1, 0.0, 325.3, 0.0, 905.2, 236.4, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.1, 0.2, 0.001, -0.0005, 0.05]
"""
    path = tmp_path / "ros.yaml"
    path.write_text(text)
    camera = fedic.read_camera(path)
    assert isinstance(camera, fedic.Pinhole)
    assert camera.focal == (900.1, 905.2)
    assert camera.distortion == fedic.BrownDistortion((-0.1, 0.2, 0.05), (1e-3, -5e-4))
    path.write_text(text.replace("plumb_bob", "equidistant"))
    with pytest.raises(fedic.CameraError, match="lens model 'equidistant' is not supported"):
        fedic.read_camera(path)


def test_both_cameras_of_a_stereo_file_are_read(tmp_path: Path) -> None:
    rotation = cv2.Rodrigues(VECTOR)[0]
    np.savez(
        tmp_path / "stereo.npz", M1=MATRIX, D1=np.zeros(5), M2=2 * MATRIX - np.diag([0, 0, 1]), R=rotation, T=[1, 2, 3]
    )
    first, second = (fedic.read_camera(tmp_path / "stereo.npz", number=number) for number in (0, 1))
    assert isinstance(first, fedic.Pinhole)
    assert isinstance(second, fedic.Pinhole)
    assert (first.focal, second.focal) == ((900.1, 905.2), (1800.2, 1810.4))
    assert (first.translation, second.translation) == ((0, 0, 0), (1, 2, 3))
    np.testing.assert_allclose(second.rotation, rotation, atol=1e-15)
    with pytest.raises(fedic.CameraError, match=r"no camera matrix of camera 2; .* holds M1, D1, M2, R, T"):
        fedic.read_camera(tmp_path / "stereo.npz", number=2)


def test_vic3d_reports_are_read(shared_data: Callable[[str], Path]) -> None:
    path = shared_data("chessboard/vic3d_calibration.txt")
    first, second = (fedic.read_camera(path, number=number) for number in (0, 1))
    assert isinstance(first, fedic.Pinhole)
    assert isinstance(second, fedic.Pinhole)
    assert first.focal == (15838.552, 15838.552)
    assert first.principal_point == (1277.543, 1050.145)
    assert first.distortion == fedic.BrownDistortion((0.002, 2.764, 0.0))
    assert second.principal_point == (1253.146, 1040.541)
    assert second.distortion == fedic.BrownDistortion((-0.018, 6.627, 0.0))
    np.testing.assert_array_equal(first.rotation, np.eye(3))
    assert second.translation == (-257.260, -0.838, 77.390)
    # The mean magnifications of the report, 31.2172 and 30.5585 px/mm, are focal length over distance: the point on the
    # first optical axis at the first distance must be at the second distance from the second camera, and in its image.
    point = np.array([0.0, 0.0, first.focal[0] / 31.2172])
    from_second = second.rotation @ point + second.translation
    assert second.focal[0] / from_second[2] == pytest.approx(30.5585, rel=2e-3)
    assert np.linalg.norm(second.project([point])[0] - second.principal_point) < 300.0
    with pytest.raises(fedic.CameraError, match="there is no camera 2; the report holds Camera 0 intr"):
        fedic.read_camera(path, number=2)


REPORT = """\
Camera 0 intrinsics:
Center (X): 1277.5 +/- 0.8
Center (Y): 1050.1 +/- 1.1
Focal Length (X): 15838.5 +/- 2.1
Focal Length (Y): 15838.5 +/- 0.0
Kappa 1: 0.002 +/- 0.003

Camera 1 intrinsics:
Center (X): 1253.1
Center (Y): 1040.5
Focal Length (X): 15837.8
Focal Length (Y): 15837.8

Extrinsics:

Angles:
X: 1.0
Y: 30.0
Z: 2.0

Distances:
X [mm]: -257.0
Y [mm]: -0.8
"""

CALDAT = """\
Cam1_Fx [pixels];6673.3
Cam1_Fy [pixels];6669.3
Cam1_Fs [pixels];0
Cam1_Kappa 1;0.03
Cam1_Kappa 2;-1.0
Cam1_Kappa 3;29.8
Cam1_P1;0.001
Cam1_P2;0.002
Cam1_Cx [pixels];872.2
Cam1_Cy [pixels];580.0
Cam2_Fx [pixels];6607.6
Cam2_Fy [pixels];6602.9
Cam2_Fs [pixels];3
Cam2_Kappa 1;0.06
Cam2_Cx [pixels];918.0
Cam2_Cy [pixels];531.6
Tx [mm];122.2
Ty [mm];1.8
Tz [mm];17.6
Theta [deg];0.13
Phi [deg];-19.07
Psi [deg];0.28
"""


def test_matchid_calibrations_are_read(tmp_path: Path) -> None:
    path = tmp_path / "pair.caldat"
    path.write_text(CALDAT)
    first, second = (fedic.read_camera(path, number=number) for number in (0, 1))
    assert isinstance(first, fedic.Pinhole)
    assert isinstance(second, fedic.Pinhole)
    assert (first.focal, first.principal_point) == ((6673.3, 6669.3), (872.2, 580.0))
    assert first.distortion == fedic.BrownDistortion((0.03, -1.0, 29.8), (0.001, 0.002))
    assert second.translation == (122.2, 1.8, 17.6)
    turns = [
        cv2.Rodrigues(np.radians(angle) * axis)[0] for angle, axis in zip((0.13, -19.07, 0.28), np.eye(3), strict=True)
    ]
    np.testing.assert_allclose(second.rotation, turns[2] @ turns[1] @ turns[0], atol=1e-14)
    # The shear of the second camera: u = fx x + fs y + cx.
    ahead = second.rotation.T @ (np.array([0.1, 0.2, 1.0]) * 1000 - second.translation)
    expected = (6607.6 * 0.1 + 3 * 0.2 + 918.0, 6602.9 * 0.2 + 531.6)
    straight = fedic.Pinhole(
        second.focal, second.principal_point, second.rotation, second.translation, second.skew_angle
    )
    np.testing.assert_allclose(straight.project([ahead])[0], expected, rtol=1e-12)
    path.write_text(CALDAT.replace("Cam1", "Cam0").replace("Cam2", "Cam1"))
    same(fedic.read_camera(path), first)


def matrices(**arrays: Any) -> dict[str, NDArray[np.float64]]:
    return {"K": MATRIX, **arrays}


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.json", b"", "'.json' is not a camera format; give one of .toml, .yml"),
        ("a.yml", None, "there is no such camera file"),
        ("a.yml", b"%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   co", "truncated, or of another"),
        ("a.xml", b"<?xml version='1.0'?><opencv_storage><camera_mat", "truncated, or of another format"),
        ("a.yml", b"\xff\xfe\x00", "cannot be read as text"),
        ("a.yml", b"%YAML:1.0\n---\nfocal: 3\n", "no camera matrix; name it camera_matrix.* the file holds focal"),
        ("a.yml", b"%YAML:1.0\n---\ncamera_matrix: 3\n", "camera_matrix is not a matrix"),
        ("a.yml", b"%YAML:1.0\n---\ncamera_matrix: [1, 2]\n", "camera_matrix holds 2 numbers instead of 9"),
        ("a.npz", b"PK", "NumPy cannot read this file"),
        ("a.npz", matrices(D=np.zeros((1, 8)) + 0.1), "D has k4 = 0.1, k5 = 0.1, k6 = 0.1: the rational"),
        ("a.npz", matrices(D=np.r_[np.zeros(9), 1e-3]), "D holds 10 coefficients; OpenCV writes 4, 5, 8"),
        ("a.npz", matrices(D=np.r_[np.zeros(12), 0.1, 0.0]), "D has tau_x = 0.1"),
        ("a.npz", matrices(D=np.r_[np.zeros(11), 0.1]), "D has s4 = 0.1"),
        ("a.npz", matrices(D=[np.nan, 0, 0, 0]), "D holds NaN"),
        ("a.npz", matrices(rvec=[1.0, 2.0]), "rvec holds 2 numbers, not 3 or 9"),
        ("a.npz", matrices(tvec=[1.0, 2.0]), "tvec holds 2 numbers instead of 3"),
        ("a.npz", {"K": MATRIX.T}, "K is not a camera matrix"),
        ("a.npz", {"K": -MATRIX + np.diag([0, 0, 2])}, "focal length .* must be positive"),
        ("a.npz", {"K": np.array(["a"])}, "K does not hold numbers"),
        ("a.npz", {}, "no camera matrix; .* the file holds nothing"),
        ("a.txt", b"hello", "no line 'Camera 0 intrinsics:'; is this a calibration report"),
        ("a.txt", REPORT.replace("Center (Y): 1050.1 +/- 1.1\n", "").encode(), "Camera 0 .*: Center .Y. is missing"),
        ("a.txt", REPORT.replace("0.002 +/- 0.003", "n/a").encode(), "Kappa 1 = 'n/a' is not a number"),
        ("a.txt", REPORT.replace("Kappa 1", "Kappa 4").encode(), "Kappa 4 = 0.002 .* is not in fedic's lens model"),
        ("a.caldat", b"hello", "no key such as 'Cam1_Fx"),
        ("a.caldat", CALDAT.replace("Cam1_Cx [pixels];872.2\n", "").encode(), "Cam1_Cx is missing"),
        ("a.caldat", CALDAT.replace("872.2", "").encode(), "Cam1_Cx .* = '' is not a number; is the file truncated"),
        ("a.caldat", CALDAT.replace("Cam1_P2", "Cam1_S1").encode(), "Cam1_S1 = 0.002 is not in fedic's lens model"),
        ("a.toml", b"model = ", "not a valid TOML file"),
        ("a.toml", b'model = "pinhole"', "a.toml: focal is missing"),
        ("a.toml", b'model = "pinhole"\nfocal = [1.0, -1.0]', r"a.toml: focal\[1\] = -1.0 should be greater than 0"),
        ("a.toml", b'file = "b.toml"', "file names another camera file"),
    ],
)  # fmt: skip
def test_errors_name_the_file_and_the_key(name: str, content: Any, message: str, tmp_path: Path) -> None:
    path = tmp_path / name
    if isinstance(content, dict):
        np.savez(path, **content)
    elif content is not None:
        path.write_bytes(content)
    with pytest.raises(fedic.CameraError, match=message) as caught:
        fedic.read_camera(path)
    assert name in str(caught.value)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("pair.txt", REPORT, "Extrinsics, Distances: Z is missing"),
        ("pair.caldat", CALDAT.replace("Psi", "Chi"), "Psi, part of the pose of the second camera, is missing"),
    ],
)
def test_an_incomplete_relative_pose_affects_only_the_second_camera(
    name: str, text: str, message: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_text(text)
    fedic.read_camera(tmp_path / name)
    with pytest.raises(fedic.CameraError, match=message):
        fedic.read_camera(tmp_path / name, number=1)


CONFIG = """\
[images]
reference = "r.png"
deformed = "r.png"
[mesh.rectangle]
bounds = [0, 0, 10, 10]
size = 5
[camera]
file = "camera.yml"
{more}
[output]
folder = "out"
"""


def configured(folder: Path, more: str = "") -> Path:
    (folder / "r.png").touch()
    path = folder / "run.toml"
    path.write_text(CONFIG.format(more=more))
    return path


def test_a_configuration_reads_a_camera_file(tmp_path: Path) -> None:
    path = configured(tmp_path)
    with pytest.raises(fedic.CameraError, match=r"run.toml: camera.file names .*camera.yml, which does not exist"):
        load_config(path)
    fedic.write_camera(CAMERA, tmp_path / "camera.yml")
    same(load_config(path).camera.build(), CAMERA)
    moved = load_config(configured(tmp_path, "rotation = [3.1, 0, 0]\ntranslation = [0, 0, 50]")).camera.build()
    assert isinstance(moved, fedic.Pinhole)
    assert (moved.focal, moved.translation, moved.distortion) == (CAMERA.focal, (0, 0, 50), CAMERA.distortion)
    np.testing.assert_allclose(moved.rotation, cv2.Rodrigues(np.array([3.1, 0, 0]))[0], atol=1e-15)


@pytest.mark.parametrize(
    ("more", "key", "message"),
    [
        ("numbr = 1", "camera.numbr", 'did you mean "number"'),
        ("number = -1", "camera.number", "greater than or equal to 0"),
        ("rotation = [1.0]", "camera.rotation", "should be a rotation vector of 3 numbers"),
    ],
)
def test_errors_in_the_camera_section_name_the_key(more: str, key: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(fedic.ConfigError, match=message) as caught:
        load_config(configured(tmp_path, more))
    assert caught.value.key == key
