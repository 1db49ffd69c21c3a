"""Camera files of other programs, written by their conventions from one pair of cameras."""

import re
from pathlib import Path

import numpy as np
import pytest

import fedic
from scenes.camera_files import FILES
from scenes.camera_files.camera_file import CameraFile, outcome
from scenes.camera_files.image_correlation import caldat, dice, project
from scenes.camera_files.matlab import matlab_struct


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.program)
def test_each_program_gives_the_same_camera_or_is_refused_by_name(file: CameraFile, tmp_path: Path) -> None:
    pytest.importorskip("h5py" if file.by == "h5py" else "scipy" if file.name.endswith(".mat") else "numpy")
    assert outcome(file, tmp_path).startswith("refused" if isinstance(file.expected, str) else "read")


@pytest.mark.parametrize(
    "file",
    [each for each in FILES if each.number == 1 and not isinstance(each.expected, str)],
    ids=lambda each: each.program,
)
def test_the_first_of_two_cameras_is_the_world_and_a_third_is_refused(file: CameraFile, tmp_path: Path) -> None:
    path = file.make(tmp_path)
    first = fedic.read_camera(path)
    assert isinstance(first, fedic.Pinhole)
    np.testing.assert_array_equal(first.rotation, np.eye(3))
    assert first.translation == (0.0, 0.0, 0.0)
    for number in (2, -1, 7):
        with pytest.raises(fedic.CameraError, match=rf"no camera (matrix of camera )?{number}"):
            fedic.read_camera(path, number=number)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.caldat", caldat(length="m"), r"Tx is in \[m\]; fedic reads it in mm"),
        ("a.caldat", caldat().replace("Fx [pixels]", "Fx [mm]"), r"Cam1_Fx is in \[mm\]; fedic reads it in px"),
        ("a.caldat", caldat().replace("318.25", "318,25"), "has a comma and .* a point; which one"),
        ("a.caldat", caldat().replace("1200.0", "1.200,0"), "'1.200,0' is not a number"),
        ("a.caldat", caldat() + "Tx [mm];3\n", "Tx is there twice"),
        ("a.xml", dice().replace('name="K1"', 'name="K4"'), "has k4 = -0.12"),
        ("a.xml", dice("K1R2_K2R4_K3R6"), "K1R2_K2R4_K3R6 is not supported"),
        ("a.xml", dice(""), "coefficients of a lens, but no LENS_DISTORTION_MODEL"),
        ("a.xml", dice().replace('name="P1"', 'name="FS"'), "FS = 0.0011: DICe says"),
        ("a.xml", project().replace(" 0 -0.12", " -0.12"), "camera 0 holds 7 numbers instead of 8"),
        ("a.xml", "<html/>", "the root is <html>; fedic reads <opencv_storage>"),
        ("a.txt", "1.0\n2.0\n", "2 numbers; a text file of DICe has 24"),
        ("a.txt", "1.0\n2.0\n" * 12, "camera 0, FS = 1: DICe says"),
    ],
)  # fmt: skip
def test_other_units_models_and_shapes_are_refused(name: str, content: str, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(fedic.CameraError, match=message):
        fedic.read_camera(tmp_path / name)


def test_the_pose_of_a_second_camera_may_come_from_the_configuration(tmp_path: Path) -> None:
    from fedic.campaign.config.camera_section import CameraFileSection

    file = next(each for each in FILES if each.program == "OpenCV stereo without R, T")
    path = file.make(tmp_path)
    section = CameraFileSection(file=path, number=1, rotation=[0.0, 0.1, 0.0], translation=(1.0, 2.0, 3.0))
    camera = section.build()
    assert isinstance(camera, fedic.Pinhole)
    assert camera.translation == (1.0, 2.0, 3.0)
    with pytest.raises(fedic.CameraError, match=re.escape(f"{path}: the rotation and the translation of camera 1")):
        CameraFileSection(file=path, number=1, rotation=[0.0, 0.1, 0.0]).build()


def test_a_struct_of_two_cameras_without_a_matrix_is_refused(tmp_path: Path) -> None:
    savemat = pytest.importorskip("scipy.io").savemat
    savemat(tmp_path / "a.mat", {"CameraParameters1": {"RadialDistortion": np.zeros((1, 2))}})
    with pytest.raises(fedic.CameraError, match="FocalLength holds 0 numbers instead of 2"):
        fedic.read_camera(tmp_path / "a.mat")
    savemat(
        tmp_path / "a.mat",
        {"K": np.eye(3), "RadialDistortion": np.zeros((1, 2)), "many": np.zeros((200, 200)), "c": 1j},
    )
    with pytest.raises(fedic.CameraError, match=r"there is no camera 1; the file holds one"):
        fedic.read_camera(tmp_path / "a.mat", number=1)
    savemat(tmp_path / "a.mat", {"name": "text", "K": np.eye(3)})
    with pytest.raises(fedic.CameraError, match=r"no camera parameters: .* An object of MATLAB cannot be read"):
        fedic.read_camera(tmp_path / "a.mat")


@pytest.mark.parametrize("compressed", [False, True])
def test_matlab_files_of_both_compressions_are_read(compressed: bool, tmp_path: Path) -> None:
    savemat = pytest.importorskip("scipy.io").savemat
    struct = matlab_struct() | {
        "ImageSize": np.array([[480, 640]], dtype=np.uint16),
        "ab": "text",
        "cell": np.array([{}]),
    }
    savemat(tmp_path / "a.mat", {"p": struct}, do_compression=compressed, oned_as="row")
    camera = fedic.read_camera(tmp_path / "a.mat")
    assert camera.image_size == (640, 480)
    assert isinstance(camera, fedic.Pinhole)
    assert camera.focal == (1200.0, 1195.0)
