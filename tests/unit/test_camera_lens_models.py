"""Names of lens models in files: those of Brown's are read, all others refused."""

from pathlib import Path

import numpy as np
import pytest

import fedic
from scenes.camera_files.robotics import message

TEXT = """\
image_width: 1280
image_height: 1024
camera_matrix: [1000.0, 0.0, 640.0, 0.0, 1001.0, 512.0, 0.0, 0.0, 1.0]
{key}: {model}
distortion_coefficients: [{coefficients}]
"""


def write(
    folder: Path, model: str, coefficients: str = "-0.02, 0.03, -0.001, 0.002", key: str = "distortion_model"
) -> Path:
    path = folder / "a.yaml"
    path.write_text(TEXT.format(key=key, model=model, coefficients=coefficients))
    return path


@pytest.mark.parametrize(
    "model",
    ["plumb_bob", "PLUMB-BOB", "Plumb Bob", "RadTan", "radial-tangential", "brown", "Brown-Conrady", "OpenCV", "''"],
)
def test_browns_model_is_read_in_any_spelling(model: str, tmp_path: Path) -> None:
    camera = fedic.read_camera(write(tmp_path, model))
    assert isinstance(camera, fedic.Pinhole)
    assert camera.distortion == fedic.BrownDistortion((-0.02, 0.03, 0.0), (-0.001, 0.002))
    assert camera.image_size == (1280, 1024)


@pytest.mark.parametrize(
    "model",
    [
        *("kannala_brandt", "Kannala Brandt 4", "EQUIDISTANT", "equi", "fov", "inverse_brown_conrady", "fisheye"),
        *("modified_brown_conrady", "thin_prism", "ftheta", "double_sphere"),
    ],
)
def test_other_models_are_refused_by_name(model: str, tmp_path: Path) -> None:
    with pytest.raises(fedic.CameraError, match=f"distortion_model: the lens model '{model}' is not supported"):
        fedic.read_camera(write(tmp_path, model))


def test_the_rational_model_is_browns_without_its_denominator(tmp_path: Path) -> None:
    found = fedic.read_camera(write(tmp_path, "rational_polynomial", "-0.1, 0.2, 0.001, 0.002, 0.3, 0, 0, 0"))
    assert isinstance(found, fedic.Pinhole)
    assert found.distortion == fedic.BrownDistortion((-0.1, 0.2, 0.3), (0.001, 0.002))
    with pytest.raises(fedic.CameraError, match=r"k5 = 0\.1: the rational"):
        fedic.read_camera(write(tmp_path, "rational_polynomial", "-0.1, 0.2, 0.001, 0.002, 0.3, 0, 0.1, 0"))


@pytest.mark.parametrize(
    ("key", "model"),
    [
        *(("camera_model", "omni"), ("cameraModel", "fisheye"), ("model_type", "MEI")),
        *(("fisheye_model", "1"), ("Using_Fisheye", "true")),
    ],
)
def test_other_projections_are_refused(key: str, model: str, tmp_path: Path) -> None:
    with pytest.raises(fedic.CameraError, match=f"{key}.*not supported"):
        fedic.read_camera(write(tmp_path, model, key=key))
    for harmless in ("pinhole", "Pinhole") if "odel" in key and "fish" not in key else ("0", "false"):
        fedic.read_camera(write(tmp_path, harmless, key=key))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (message().replace("1200.0, 0.0, 318.25", "0, 0, 0"), "must be positive"),
        (message("DKR").replace(", 1195.0", ""), "K holds 8 numbers instead of 9"),
        (message(more="binning_x: 1.5\n"), "binning_x = 1.5 should be a whole number"),
        (message(more="roi:\n  x_offset: -3\n"), "x_offset = -3 should be a whole number"),
        (message(model="equidistant"), "lens model 'equidistant'"),
        ("K: [0,0,0,0,0,0,0,0,0]\nP: []\nD: []\n", "K is zero: the driver of this camera has no calibration"),
    ],
)
def test_messages_that_describe_no_camera_are_refused(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(text)
    with pytest.raises(fedic.CameraError, match=message):
        fedic.read_camera(tmp_path / "a.yaml")


def test_the_same_message_many_times_is_one_camera(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("---\n".join([message()] * 4) + "---\n")
    many = fedic.read_camera(path)
    path.write_text(message())
    assert many == fedic.read_camera(path)
    assert isinstance(many, fedic.Pinhole)
    np.testing.assert_array_equal(many.rotation, np.eye(3))
    with pytest.raises(fedic.CameraError, match="there is no camera 1"):
        fedic.read_camera(path, number=1)
