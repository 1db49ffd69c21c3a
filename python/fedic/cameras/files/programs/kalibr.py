"""Cameras of Kalibr (``camchain.yaml``) and of the EuRoC data sets (``sensor.yaml``)."""

from pathlib import Path

import numpy as np

from fedic._core import Pinhole
from fedic._internal.types import Floats
from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.lens_models import check_lens_model, check_projection
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.cameras.files.programs.opencv import size_of_image
from fedic.cameras.files.syntax.tree import Tree, numbers, text_of
from fedic.errors import CameraError

__all__ = ["euroc_camera", "is_camchain", "is_euroc", "kalibr_camera"]


_COEFFICIENTS = ("distortion_coeffs", "distortion_coefficients")
"""Key of the coefficients in the files of Kalibr and of EuRoC."""
_NO_LENS = ("", "none", "no_distortion")


def is_camchain(document: Tree) -> bool:
    """Return true if a YAML document is a camera chain of Kalibr."""
    return isinstance(document, dict) and isinstance(document.get("cam0"), dict) and "intrinsics" in document["cam0"]


def is_euroc(document: Tree) -> bool:
    """Return true if a YAML document describes a camera of a EuRoC data set."""
    return isinstance(document, dict) and "intrinsics" in document and "distortion_model" in document


def kalibr_camera(path: Path, document: dict[str, Tree], number: int) -> FileCamera:
    """Return a camera of a chain; the world is the frame of the first.

    ``T_cn_cnm1`` of each camera maps the frame of the one before to its own.
    """
    name = f"cam{number}"
    if not isinstance(document.get(name), dict):
        names = [key for key in document if key.startswith("cam")]
        raise CameraError(f"{path}: there is no camera {number}; the chain holds {', '.join(names)}.")
    pose: Floats = np.eye(4)
    missing = ""
    for index in range(1, number + 1):
        link = document.get(f"cam{index}", {})
        if not isinstance(link, dict) or "T_cn_cnm1" not in link:
            missing = f"T_cn_cnm1 of cam{index}, part of the pose of camera {number}, is missing."
            break
        step = numbers(path, f"cam{index}.T_cn_cnm1", link["T_cn_cnm1"], 16).reshape(4, 4)
        pose = step @ pose
    if missing:
        pose = np.eye(4)
    return FileCamera(_camera(path, f"{name}.", document[name], pose), missing)


def euroc_camera(path: Path, document: dict[str, Tree], number: int) -> FileCamera:
    """Return the camera of a sensor file; its place on the body, ``T_BS``, is no pose of the specimen and not used."""
    if number != 0:
        raise CameraError(f"{path}: there is no camera {number}; a sensor file describes one, number 0.")
    return FileCamera(_camera(path, "", document, np.eye(4)))


def _camera(path: Path, prefix: str, tree: dict[str, Tree], pose: Floats) -> Pinhole:
    check_projection(path, f"{prefix}camera_model", text_of(tree.get("camera_model", "")))
    model = text_of(tree.get("distortion_model", ""))
    check_lens_model(path, f"{prefix}distortion_model", model)
    lens = next((name for name in _COEFFICIENTS if name in tree), "")
    if not lens and model.lower() not in _NO_LENS:
        raise CameraError(f"{path}: {prefix}{_COEFFICIENTS[0]}, those of {model}, are missing; is the file truncated?")
    fx, fy, cx, cy = numbers(path, f"{prefix}intrinsics", tree.get("intrinsics", []), 4)
    return camera_from_matrices(
        path,
        (f"{prefix}intrinsics", np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])),
        (f"{prefix}{lens}", tree[lens]) if lens else None,
        (f"{prefix}T_cn_cnm1", pose[:3, :3]),
        (f"{prefix}T_cn_cnm1", pose[:3, 3]),
        size_of_image(path, tree),
    )
