"""Cameras in the YAML and XML files of OpenCV's ``FileStorage``, and in the plain YAML of ROS."""

from pathlib import Path
from typing import Any

import numpy as np

from fedic._core import Pinhole
from fedic.cameras.files.matrices import camera_from_matrices, matrices_of_camera
from fedic.errors import CameraError
from fedic.io.atomic import atomic_path

__all__ = ["KEYS", "find_key", "read_opencv", "write_opencv"]

KEYS = {
    "matrix": (
        "camera_matrix", "cameraMatrix", "Camera_Matrix", "CameraMatrix", "intrinsic_matrix", "intrinsics", "mtx", "K",
    ),
    "distortion": (
        "distortion_coefficients", "Distortion_Coefficients", "distortion", "dist_coeffs", "dist_coeff", "distCoeffs",
        "dist_coefs", "dist", "D",
    ),
    "rotation": ("rvec", "rotation_vector", "rotation_matrix", "rotation", "R"),
    "translation": ("tvec", "translation_vector", "translation", "T", "t"),
}  # fmt: skip
"""Keys under which other programs store each matrix."""

_PAIRS = {
    "matrix": ("M{}", "K{}", "cameraMatrix{}", "camera_matrix_{}", "mtx{}"),
    "distortion": ("D{}", "distCoeffs{}", "dist_coeffs_{}", "dist{}"),
}
_OTHER_MODELS = ("equidistant", "fisheye", "rational_polynomial", "thin_prism")


def find_key(path: Path, names: list[str], number: int) -> dict[str, str]:
    """Return the key of each matrix in a file.

    Parameters
    ----------
    path : Path
        The file, for messages.
    names : list of str
        Keys in the file.
    number : int
        Index of the camera, 0 or 1.

    Returns
    -------
    dict of str to str
        Keys of ``matrix`` and, if present, of ``distortion``, ``rotation`` and ``translation``.

    Raises
    ------
    CameraError
        If there is no camera matrix, or no such camera.
    """
    single = {what: next((key for key in keys if key in names), "") for what, keys in KEYS.items()}
    forms = {what: [key.format(number + 1) for key in keys] for what, keys in _PAIRS.items()}
    paired = {what: next((key for key in keys if key in names), "") for what, keys in forms.items()}
    if single["matrix"]:
        if number != 0:
            raise CameraError(f"{path}: there is no camera {number}; the file holds one, number 0.")
        return {what: key for what, key in single.items() if key}
    if not paired["matrix"]:
        expected = ", ".join([*KEYS["matrix"], *forms["matrix"]])
        raise CameraError(
            f"{path}: there is no camera matrix {f'of camera {number} ' if number else ''}under any of the keys "
            f"{expected}; the file holds {', '.join(names) or 'nothing'}."
        )
    pose = {what: single[what] for what in ("rotation", "translation")} if number else {}
    return {what: key for what, key in {**paired, **pose}.items() if key}


def read_opencv(path: Path, number: int) -> Pinhole:
    """Read a camera from a file of OpenCV's ``FileStorage`` or of ROS."""
    root, storage = _opened(path)
    names = [name for name in root.keys() if root.getNode(name) is not None]  # noqa: SIM118 - a FileNode is not a dict
    model = root.getNode("distortion_model").string() if "distortion_model" in names else ""
    if model in _OTHER_MODELS or ("fisheye_model" in names and root.getNode("fisheye_model").real() != 0.0):
        raise CameraError(
            f"{path}: the lens model {model or 'fisheye'!r} is not supported; calibrate as a pinhole camera."
        )
    keys = find_key(path, names, number)
    found = {what: (key, _matrix(path, key, root.getNode(key))) for what, key in keys.items()}
    storage.release()
    return camera_from_matrices(
        path, found["matrix"], found.get("distortion"), found.get("rotation"), found.get("translation")
    )


def write_opencv(camera: object, path: Path) -> None:
    """Write a camera in the format of OpenCV's sample programs, with its pose as ``rvec`` and ``tvec``."""
    import cv2

    matrix, distortion, rotation, translation = matrices_of_camera(path, camera)
    with atomic_path(path) as temporary:
        storage = cv2.FileStorage(str(temporary), cv2.FILE_STORAGE_WRITE)
        if not storage.isOpened():
            raise FileNotFoundError(temporary)
        storage.write("camera_matrix", matrix)
        storage.write("distortion_coefficients", distortion)
        storage.write("rvec", cv2.Rodrigues(rotation)[0])
        storage.write("tvec", translation.reshape(3, 1))
        storage.release()


def _opened(path: Path) -> tuple[Any, Any]:
    """Return the root of a file and its storage."""
    import cv2

    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CameraError(f"{path}: the camera file cannot be read as text ({error}).") from error
    if path.suffix.lower() != ".xml" and not text.startswith("%YAML"):
        text = "%YAML:1.0\n---\n" + text
    try:
        storage = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
        root = storage.root() if storage.isOpened() else None
        if root is not None and root.isMap():
            return root, storage
    except (cv2.error, SystemError) as error:
        raise CameraError(f"{path}: OpenCV cannot read this file: truncated, or of another format.") from error
    raise CameraError(f"{path}: OpenCV cannot read this file: truncated, or of another format.")


def _matrix(path: Path, key: str, node: Any) -> np.ndarray[Any, Any]:
    """Return a matrix of OpenCV, a list of numbers, or the ``data`` of a map written by ROS."""
    if node.isMap():
        try:
            matrix = node.mat()
        except Exception:  # a map that is not a matrix of OpenCV
            matrix = None
        if matrix is not None:
            return np.asarray(matrix)
        node = node.getNode("data")
    if not node.isSeq():
        raise CameraError(f"{path}: {key} is not a matrix.")
    return np.array([node.at(index).real() for index in range(node.size())])
