"""Cameras of MATLAB: a struct of ``toStruct(cameraParameters)``, or Bouguet's toolbox, in a ``.mat`` file."""

from pathlib import Path
from typing import Any

import numpy as np

from fedic._internal.types import Floats
from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.cameras.files.syntax.mat_trees import read_mat
from fedic.cameras.files.syntax.tree import Tree, numbers
from fedic.errors import CameraError

__all__ = ["read_matlab"]

_ADVICE = "save a struct: s = toStruct(cameraParams); save('camera.mat', '-struct', 's')"

_BOUGUET = ("fc", "cc", "kc")
"""Names in the files of Bouguet's calibration toolbox: focal lengths, principal point, k1 k2 p1 p2 k3."""


def read_matlab(path: Path, number: int) -> FileCamera:
    """Read a camera.

    MATLAB multiplies rows from the left, so that ``IntrinsicMatrix`` and the rotations are transposed (``K`` is not).
    Its first pixel is (1, 1). The world is the frame of the camera, or of the first of two.
    """
    content = read_mat(path)
    if all(name in content for name in _BOUGUET):
        return _of_bouguet(path, content, number)
    found = _parameters(content)
    if found is None:
        raise CameraError(
            f"{path}: no camera parameters: no RadialDistortion beside a matrix (IntrinsicMatrix, K); it holds "
            f"{', '.join(content) or 'nothing fedic can read'}. An object of MATLAB cannot be read: {_ADVICE}."
        )
    if "CameraParameters1" not in found:
        if number != 0:
            raise CameraError(f"{path}: there is no camera {number}; the file holds one, number 0.")
        return FileCamera(_camera(path, found))
    own = found.get(f"CameraParameters{number + 1}")
    if number not in (0, 1) or not isinstance(own, dict):
        raise CameraError(f"{path}: there is no camera {number} that is a struct; {_ADVICE}, of stereoParams too.")
    keys = ("RotationOfCamera2", "TranslationOfCamera2")
    absent = next((key for key in keys if key not in found), None) if number else None
    missing = f"{absent}, part of the pose of the second camera, is missing." if absent else ""
    pose: dict[str, tuple[str, Tree]] = {}
    if number and not missing:
        rotation = numbers(path, keys[0], found[keys[0]], 9).reshape(3, 3).T
        pose = {"rotation": (keys[0], rotation), "translation": (keys[1], found[keys[1]])}
    return FileCamera(_camera(path, own, **pose), missing)


def _parameters(content: dict[str, Tree]) -> dict[str, Tree] | None:
    """Return the struct of a camera or of two, at the top or one below."""
    names = ("RadialDistortion", "CameraParameters1")
    structs = [content, *(value for value in content.values() if isinstance(value, dict))]
    return next((struct for struct in structs if any(name in struct for name in names)), None)


def _of_bouguet(path: Path, content: dict[str, Tree], number: int) -> FileCamera:
    """Return the camera of ``Calib_Results.mat``, whose first pixel is (0, 0) and whose lens is OpenCV's."""
    if number != 0:
        raise CameraError(f"{path}: there is no camera {number}; the file holds one, number 0.")
    (fx, fy), (cx, cy) = (numbers(path, name, content[name], 2) for name in ("fc", "cc"))
    skew = fx * numbers(path, "alpha_c", content.get("alpha_c", 0.0), 1)[0]
    size = [numbers(path, name, content[name], 1)[0] for name in ("nx", "ny") if name in content]
    matrix = np.array([[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    image_size = (int(size[0]), int(size[1])) if len(size) == 2 and min(size) >= 1 else None
    return FileCamera(camera_from_matrices(path, ("fc", matrix), ("kc", content["kc"]), image_size=image_size))


def _camera(path: Path, struct: dict[str, Tree], **pose: tuple[str, Tree]) -> Any:
    radial = numbers(path, "RadialDistortion", struct.get("RadialDistortion", np.zeros(2)))
    tangential = numbers(path, "TangentialDistortion", struct.get("TangentialDistortion", np.zeros(2)), 2)
    if radial.size not in (2, 3):
        raise CameraError(f"{path}: RadialDistortion holds {radial.size} numbers, not 2 or 3.")
    size = None
    if "ImageSize" in struct and np.size(struct["ImageSize"]):
        rows, columns = numbers(path, "ImageSize", struct["ImageSize"], 2)
        size = (int(columns), int(rows)) if rows >= 1 and columns >= 1 else None
    key, matrix = _matrix(path, struct)
    matrix[:2, 2] -= 1.0
    coefficients = np.concatenate([radial[:2], tangential, radial[2:]])
    return camera_from_matrices(path, (key, matrix), ("RadialDistortion", coefficients), image_size=size, **pose)


def _matrix(path: Path, struct: dict[str, Tree]) -> tuple[str, Floats]:
    """Return the intrinsic matrix, with MATLAB's origin of the pixels, and its key."""
    if "K" in struct:
        return "K", numbers(path, "K", struct["K"], 9).reshape(3, 3).copy()
    if "IntrinsicMatrix" in struct:
        return "IntrinsicMatrix", numbers(path, "IntrinsicMatrix", struct["IntrinsicMatrix"], 9).reshape(3, 3).T.copy()
    fx, fy = numbers(path, "FocalLength", struct.get("FocalLength", []), 2)
    cx, cy = numbers(path, "PrincipalPoint", struct.get("PrincipalPoint", []), 2)
    skew = numbers(path, "Skew", struct.get("Skew", 0.0), 1)[0]
    return "FocalLength", np.array([[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
