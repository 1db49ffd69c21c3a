"""Rotation matrices that were printed with few digits."""

import warnings
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fedic
from fedic.cameras.rotations import nearest_rotation

ANGLE = st.floats(-np.pi, np.pi)


@given(ANGLE, ANGLE, ANGLE, st.integers(3, 16))
def test_a_printed_rotation_is_the_nearest_one(x: float, y: float, z: float, digits: int) -> None:
    rotation = cv2.Rodrigues(np.array([x, y, z]))[0]
    printed = np.round(rotation, digits)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        found = nearest_rotation("a.yml: R", printed)
    off = np.abs(printed - found).max()
    np.testing.assert_allclose(found, rotation, rtol=0, atol=2.0 * 10.0**-digits)
    assert np.abs(found @ found.T - np.eye(3)).max() < 1e-11
    assert np.linalg.det(found) > 0.0
    assert [warning.category for warning in said] == ([fedic.CalibrationWarning] if off > 1e-6 else [])
    fedic.Pinhole((9, 9), (0, 0), found)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.diag([1.0, 1.0, 1.004]), "R is not a rotation: an entry is 4.0e-03 from"),
        (np.zeros((3, 3)), "R is not a rotation"),
        (np.diag([1.0, 1.0, -1.0]), "R is a reflection, not a rotation"),
        (-np.eye(3), "R is a reflection"),
        (np.full((3, 3), np.nan), "R holds NaN"),
    ],
)
def test_other_matrices_are_refused(matrix: np.ndarray, message: str) -> None:
    with pytest.raises(fedic.CameraError, match=message):
        nearest_rotation("a.yml: R", matrix)


@pytest.mark.parametrize("digits", [4, 5, 6])
def test_every_file_takes_the_nearest_rotation(digits: int, tmp_path: Path) -> None:
    rotation = cv2.Rodrigues(np.array([3.05, 0.12, -0.2]))[0]
    rows = np.round(rotation, digits).tolist()
    yaml, toml, npz = tmp_path / "a.yml", tmp_path / "a.toml", tmp_path / "a.npz"
    yaml.write_text(f"K: [9, 0, 1, 0, 9, 1, 0, 0, 1]\nR: {[number for row in rows for number in row]}\nT: [1, 2, 3]\n")
    toml.write_text(
        f'model = "pinhole"\nfocal = [9.0, 9.0]\nprincipal_point = [1.0, 1.0]\nrotation = {rows}\n'
        "translation = [1.0, 2.0, 3.0]\n"
    )
    np.savez(npz, K=[[9, 0, 1], [0, 9, 1], [0, 0, 1]], R=rows, T=[1, 2, 3])
    for path in (yaml, toml, npz):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", fedic.CalibrationWarning)
            found = fedic.read_camera(path)
        assert isinstance(found, fedic.Pinhole)
        np.testing.assert_allclose(found.rotation, rotation, rtol=0, atol=10.0**-digits)
    if digits < 6:
        with pytest.warns(fedic.CalibrationWarning, match=r"a\.yml: R is a rotation to .* only"):
            fedic.read_camera(yaml)


def test_a_pose_is_rotation_and_translation(tmp_path: Path) -> None:
    path = tmp_path / "a.yml"
    path.write_text("K: [9, 0, 1, 0, 9, 1, 0, 0, 1]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n")
    with pytest.raises(fedic.CameraError, match="R is there, but no translation"):
        fedic.read_camera(path)
