"""Names of matrices in camera files: spellings, pairs, and coefficients of a lens under a name that is not known."""

from pathlib import Path

import numpy as np
import pytest

import fedic

FIRST = np.array([[1200.0, 0.0, 640.0], [0.0, 1201.0, 480.0], [0.0, 0.0, 1.0]])
SECOND = np.array([[1300.0, 0.0, 641.0], [0.0, 1301.0, 482.0], [0.0, 0.0, 1.0]])
LENS, OTHER_LENS = [-0.25, 0.11, 0.001, -0.002, 0.03], [-0.2, 0.1, 0.0, 0.0, 0.0]
POSE = {"R": np.eye(3), "T": np.array([1.0, 2.0, 3.0])}


def write(path: Path, **entries: object) -> Path:
    path.write_text("".join(f"{key}: {np.asarray(value).tolist()}\n" for key, value in entries.items()))
    return path


def check(camera: object, matrix: np.ndarray, lens: list[float]) -> None:
    assert isinstance(camera, fedic.Pinhole)
    assert isinstance(camera.distortion, fedic.BrownDistortion)
    assert camera.focal == (matrix[0, 0], matrix[1, 1])
    assert camera.principal_point == (matrix[0, 2], matrix[1, 2])
    assert [*camera.distortion.radial[:2], *camera.distortion.decentering, camera.distortion.radial[2]] == lens


@pytest.mark.parametrize(
    ("matrix", "lens"),
    [
        ("CameraMatrix", "DistCoeffs"),
        ("Camera_matrix", "Dist_Coeffs"),
        ("cameramatrix", "distcoeffs"),
        ("CAMERA_MATRIX", "DISTORTION_COEFFICIENTS"),
        ("K", "kc"),
        ("mtx", "distortion_coeffs"),
        ("camera_matrix", "distortion_coefficient"),
    ],
)
def test_case_and_separators_of_names_do_not_count(tmp_path: Path, matrix: str, lens: str) -> None:
    path = write(tmp_path / "camera.yaml", **{matrix: FIRST, lens: LENS})
    check(fedic.read_camera(path), FIRST, LENS)


@pytest.mark.parametrize(
    ("matrices", "lenses"),
    [
        (("K1", "K2"), ("D1", "D2")),
        (("K0", "K1"), ("D0", "D1")),
        (("cameraMatrix0", "cameraMatrix1"), ("distCoeffs0", "distCoeffs1")),
        (("cameraMatrixL", "cameraMatrixR"), ("distL", "distR")),
        (("camera_matrix_left", "camera_matrix_right"), ("dist_coeffs_left", "dist_coeffs_right")),
        (("leftCameraMatrix", "rightCameraMatrix"), ("left_dist", "right_dist")),
        (("KL", "KR"), ("DL", "DR")),
        (("K_l", "K_r"), ("D_l", "D_r")),
        (("K1", "K2"), ("distCoeffs1", "distCoeffs2")),
        (("mtx_1", "mtx_2"), ("dist_1", "dist_2")),
    ],
)
def test_both_of_two_cameras_are_read(tmp_path: Path, matrices: tuple[str, str], lenses: tuple[str, str]) -> None:
    entries = dict(zip((*matrices, *lenses), (FIRST, SECOND, LENS, OTHER_LENS), strict=True))
    path = write(tmp_path / "pair.yaml", **entries, **POSE)
    check(fedic.read_camera(path), FIRST, LENS)
    second = fedic.read_camera(path, number=1)
    check(second, SECOND, OTHER_LENS)
    assert isinstance(second, fedic.Pinhole)
    assert second.translation == (1.0, 2.0, 3.0)
    with pytest.raises(fedic.CameraError, match="no camera matrix of camera 2"):
        fedic.read_camera(path, number=2)


@pytest.mark.parametrize(
    "entries",
    [
        {"lens_distortion": LENS},
        {"DistParams": LENS},
        {"coefficients": LENS},
        {"d": LENS},
        {"radial_distortion": LENS[:2], "tangential_distortion": LENS[2:4]},
        {"k1": -0.25, "k2": 0.11},
        {"p1": 0.001},
        {"k_1": -0.25},
        {"Kappa_1": -0.25},
    ],
)
def test_coefficients_under_an_unknown_name_are_refused(tmp_path: Path, entries: dict[str, object]) -> None:
    path = write(tmp_path / "camera.yaml", camera_matrix=FIRST, **entries)
    with pytest.raises(fedic.CameraError, match=f"{next(iter(entries))} looks like .* name them distortion_coeff"):
        fedic.read_camera(path)


@pytest.mark.parametrize(
    "entries",
    [
        {"square_distance": 25.0},
        {"circle_distances": [25.0, 25.0]},
        {"lens_distortion": [0.0, 0.0, 0.0, 0.0]},
        {"lens": "TC23036"},
        {"distortion_model": "none"},
    ],
)
def test_other_entries_are_no_lens(tmp_path: Path, entries: dict[str, object]) -> None:
    camera = fedic.read_camera(write(tmp_path / "camera.yaml", camera_matrix=FIRST, **entries))
    assert isinstance(camera, fedic.Pinhole)
    assert camera.distortion is None


def test_a_first_camera_whose_number_begins_at_zero_is_not_the_second(tmp_path: Path) -> None:
    camera = fedic.read_camera(write(tmp_path / "pair.yaml", K0=FIRST, K1=SECOND))
    assert isinstance(camera, fedic.Pinhole)
    assert camera.focal == (1200.0, 1201.0)


@pytest.mark.parametrize("name", ["distortion_coeffs", "distortion_coefficients"])
@pytest.mark.parametrize("program", ["kalibr", "euroc"])
def test_kalibr_and_euroc_share_the_names_of_coefficients(tmp_path: Path, name: str, program: str) -> None:
    lines = [
        "camera_model: pinhole",
        "intrinsics: [1200.0, 1201.0, 640.0, 480.0]",
        "distortion_model: radtan",
        f"{name}: {LENS[:4]}",
    ]
    path = tmp_path / "camera.yaml"
    path.write_text("\n".join(["cam0:", *(f"  {line}" for line in lines)] if program == "kalibr" else lines))
    check(fedic.read_camera(path), FIRST, [*LENS[:4], 0.0])
    path.write_text(path.read_text().replace(name, "other"))
    with pytest.raises(fedic.CameraError, match="distortion_coeffs, those of radtan, are missing"):
        fedic.read_camera(path)


def test_coefficients_of_anipose_under_another_name_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "calibration.toml"
    path.write_text(f"[cam_0]\nmatrix = {FIRST.tolist()}\ndistortion = {LENS}\n")
    with pytest.raises(fedic.CameraError, match=r"distortion looks like .* name them distortions,"):
        fedic.read_camera(path)
