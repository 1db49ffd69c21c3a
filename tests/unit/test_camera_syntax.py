"""Camera files of odd encodings and of hostile shapes: read, or refused with a CameraError at once."""

import io
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fedic

MATRIX = "[1000., 0, 320.5, 0, 1.0e3, .5e1, 0, 0, 1.]"
YAML = f"%YAML:1.0\n---\ncamera_matrix: {MATRIX}\n"
XML = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<opencv_storage><camera_matrix type_id="opencv-matrix"><rows>3</rows>'
    "<cols>3</cols><dt>d</dt><data>1000. 0 320.5 0 1e3 5. 0 0 1.</data></camera_matrix></opencv_storage>"
)
TOML = 'model = "pinhole"\nfocal = [1000.0, 1000.0]\nprincipal_point = [320.5, 5.0]\n'
REPORT = (
    "Camera 0 intrinsics:\nCenter (X): 320.5\nCenter (Y): 5\nFocal Length (X): 1000\nFocal Length (Y): 1000\n"
    "Comment \u00e9: 0\n"
)
CALDAT = "Cam1_Fx [pixels];1000\nCam1_Fy [pixels];1000\nCam1_Cx [pixels];320.5\nCam1_Cy [pixels];5\n"
TEXTS = {"a.yml": YAML, "a.xml": XML, "a.toml": TOML, "a.txt": REPORT, "a.caldat": CALDAT}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1"])
@pytest.mark.parametrize("name", TEXTS)
def test_every_encoding_of_windows_is_read(name: str, encoding: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(TEXTS[name].replace("\n", "\r\n").encode(encoding))
    camera = fedic.read_camera(path)
    assert isinstance(camera, fedic.Pinhole)
    assert (camera.focal, camera.principal_point) == ((1000.0, 1000.0), (320.5, 5.0))


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.yml", "a: &a [x, x]\nb: &b [*a, *a]\nK: [*b, *b]\n", r"has a reference \(\*a\)"),
        ("a.yml", "K: " + "[" * 50 + "]" * 50, "nested too deep"),
        ("a.yml", "K: " + "[" * 20000, "nest"),
        ("a.yml", "K: [1,0,2,0,1,5,0,0,1]\nK: 3\n", "the key K is there twice"),
        ("a.yml", "? [a]\n: 3\n", "a key is not a text"),
        ("a.yml", "K: !!python/object/apply:os.getcwd []\n", "K is not a matrix|K holds 0 numbers"),
        ("a.yml", "", "this file is empty"),
        ("a.yml", "- 1\n- 2\n", "not one table of keys"),
        ("a.yml", "K: [1,0,2,0,1,5,0,0,1]\nD: [" + "0.1, " * 15 + "]\n", "D holds 15 coefficients"),
        ("a.yml", "K: {rows: 3, cols: 3, dt: d, data: [1, 2, 3]}\n", "K holds 3 numbers, 9 are announced"),
        ("a.yml", "K: {rows: x, cols: 3, data: [1, 2, 3]}\n", "its sizes are not numbers"),
        ("a.yml", "K: {rows: 1e300, cols: 3, data: [1, 2, 3]}\n", "numbers"),
        ("a.yml", "K: [1,0,2,0,1,5,0,0,1]\nimage_width: 3.5\nimage_height: 2\n", "3.5 x 2 px does not exist"),
        ("a.xml", "<a>" * 50 + "</a>" * 50, "nested too deep"),
        ("a.xml", '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "defines entities"),
        ("a.xml", '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/hostname">]><a>&b;</a>', "defines entities"),
        ("a.xml", "<opencv_storage><K>1</K><K>2</K></opencv_storage>", "the key K is there twice"),
        ("a.xml", "<opencv_storage/>", "the file holds nothing"),
        ("a.toml", "a = " + "[" * 2000, "nested over 32 deep"),
        ("a.toml", "a = " + "[" * 40 + "]" * 40, "nested over 32 deep"),
        ("a.toml", ".".join("a" * 5000) + " = 1", "nested over 32 deep"),
        ("a.toml", " . ".join(["'a,b'", '"c"'] * 5000) + " = 1", "nested over 32 deep"),
        ("a.toml", "model = 'front-parallel'\nscale = " + "1" * 5000, "scale is a number with thousands of digits"),
        ("a.toml", "model = 'front-parallel'\nscale = " + "1" * 400, "scale is an integer of more than 64 bits"),
        (
            "a.toml",
            "model = 'front-parallel'\nscale = 1.0\nimage_size = [0, 5]",
            r"image_size\[0\] = 0 should be greater",
        ),
        ("a.toml", "model = 'front-parallel'\nscale = 1.0\nimage_size = [5.0, 5]", r"image_size\[0\] = 5.0 should be"),
        ("a.caldat", "Cam1_Fx [pixels];1000\0\n", "holds zero bytes"),
        ("a.mat", b"MATLAB 5.0 MAT-file", "truncated, or not a .mat file of version 5"),
        ("a.mat", b"", "truncated, or not a .mat file"),
    ],
)
def test_hostile_shapes_are_refused(name: str, content: Any, message: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(fedic.CameraError, match=message) as caught:
        fedic.read_camera(path)
    assert str(path) in str(caught.value)


def archive(**members: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in members.items():
            made.writestr(f"{name}.npy", content)
    return file.getvalue()


def array(values: Any, **heading: Any) -> bytes:
    """Return an array of NumPy's, with another heading if asked."""
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        file, {"descr": "<f8", "fortran_order": False, "shape": np.shape(values), **heading}
    )
    return file.getvalue() + np.asarray(values, dtype=float).tobytes()


K = np.array([[9.0, 0, 1], [0, 9, 1], [0, 0, 1]])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (archive(K=array(K, shape=(10**15,))), "do not have the size that the heading announces"),
        (archive(K=array(K, shape=(3, 4))), "do not have the size"),
        (archive(K=array(K, descr="|O")), "K is not a matrix|does not hold numbers"),
        (archive(K=b"\x93NUMPY\x01\x00v\x00{'descr'"), "NumPy cannot read this file"),
        (archive(K=np.random.default_rng(0).bytes(99)), "NumPy cannot read this file"),
        (array(K), "NumPy cannot read this file"),
        (archive(K=array(K))[:-40], "NumPy cannot read this file"),
    ],
)
def test_damaged_arrays_are_refused(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(content)
    with pytest.raises(fedic.CameraError, match=message):
        fedic.read_camera(path)


def test_large_arrays_beside_the_camera_are_left_out(tmp_path: Path) -> None:
    objects = np.array([{}], dtype=object)
    np.savez(tmp_path / "a.npz", K=K, points=np.zeros((200, 200)), rvecs=objects, K_fortran=np.asfortranarray(K))
    camera = fedic.read_camera(tmp_path / "a.npz")
    assert isinstance(camera, fedic.Pinhole)
    assert camera.focal == (9.0, 9.0)


def test_a_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.yml")
    with pytest.raises(fedic.CameraError, match=r"pipe\.yml: this is a device or a pipe"):
        fedic.read_camera(tmp_path / "pipe.yml")
