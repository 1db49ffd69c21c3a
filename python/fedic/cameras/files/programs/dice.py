"""Cameras of DICe: ``cal.xml`` and the older ``cal.txt``."""

import re
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from fedic._internal.types import Floats
from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.cameras.files.programs.stereo import rotation_from_angles
from fedic.cameras.files.syntax.tree import numbers
from fedic.cameras.rotations import nearest_rotation
from fedic.errors import CameraError

__all__ = ["dice_text_camera", "dice_xml_camera"]

_BROWN = ("OPENCV_LENS_DISTORTION", "OPENCV_DIS")
_RADIAL = ("K1R3_K2R5_K3R7",)
"""A displacement along the radius of k1 r^3 + k2 r^5 + k3 r^7: the radial part of Brown's model."""
_NONE = ("", "NONE", "NO_LENS_DISTORTION")
_ORDER = ("K1", "K2", "P1", "P2", "K3", "K4", "K5", "K6", "S1", "S2", "S3", "S4", "T1", "T2")
_ANGLES, _DISTANCES = ("ALPHA", "BETA", "GAMMA"), ("TX", "TY", "TZ")
_LINES = ("CX", "CY", "FX", "FY", "FS", "K1", "K2", "K3")


def dice_xml_camera(path: Path, root: Element, number: int) -> FileCamera:
    """Return a camera of an XML file.

    Each pose maps the world of the file to the camera; with ``extrinsics_relative_camera_to_camera`` that of the second
    camera maps the frame of the first to its own, and the world stays that of the first.
    """
    lists = {
        name: child for child in root.iter("ParameterList") if (name := child.get("name", "")).startswith("CAMERA ")
    }
    name = f"CAMERA {number}"
    if name not in lists:
        raise CameraError(f"{path}: there is no camera {number}; the file holds {', '.join(lists) or 'none'}.")
    own = _parameters(lists[name])
    turn, shift, posed = _pose(path, name, lists[name])
    relative = _parameters(root).get("extrinsics_relative_camera_to_camera", "false").lower() == "true"
    if number and posed and relative:
        first_turn, first_shift, _ = _pose(path, "CAMERA 0", lists["CAMERA 0"]) if "CAMERA 0" in lists else (None,) * 3
        if first_turn is not None and first_shift is not None:
            turn, shift = turn @ first_turn, turn @ first_shift + shift
    size = None
    if "IMAGE_HEIGHT_WIDTH" in own:
        height, width = _row(path, f"{name}, IMAGE_HEIGHT_WIDTH", own["IMAGE_HEIGHT_WIDTH"], 2)
        size = (int(width), int(height)) if width >= 1 and height >= 1 else None
    model = own.get("LENS_DISTORTION_MODEL", own.get("LD_MODEL", ""))
    names = ("CX", "CY", "FX", "FY", "FS", *_ORDER)
    values = {key: numbers(path, f"{name}, {key}", own.get(key, "0"), 1)[0] for key in names}
    camera = camera_from_matrices(
        path,
        (name, _matrix(path, name, values)),
        (f"{name}, {model}", _coefficients(path, name, model, values)),
        (f"{name}, rotation", turn),
        (f"{name}, translation", shift),
        size,
    )
    return FileCamera(
        camera, "" if posed or number == 0 else f"the pose of {name}, TX TY TZ and a rotation, is missing."
    )


def dice_text_camera(path: Path, text: str, number: int) -> FileCamera:
    """Return a camera of a text file, one number a line; the pose is that of the second relative to the first."""
    words = [line.split("#")[0].strip() for line in text.splitlines()]
    words = [word for word in words if word]
    if number not in (0, 1):
        raise CameraError(f"{path}: there is no camera {number}; a text file of DICe holds two, 0 and 1.")
    if len(words) not in (24, 30):
        raise CameraError(
            f"{path}: {len(words)} numbers; a text file of DICe has 24 (angles) or 30 (rotation matrix): two cameras "
            f"of {' '.join(_LINES)}, the pose, height and width of the image. Older files lack the last two: add them."
        )
    found = numbers(path, "the file", words, len(words))
    name, values = f"camera {number}", dict(zip(_LINES, found[8 * number :], strict=False))
    pose, (height, width) = found[16:-2], found[-2:]
    turn = rotation_from_angles(*pose[:3]) if len(pose) == 6 else nearest_rotation(f"{path}: R", pose[:9].reshape(3, 3))
    camera = camera_from_matrices(
        path,
        (name, _matrix(path, name, values)),
        (name, _coefficients(path, name, "K1R1_K2R2_K3R3", values)),
        (f"{name}, rotation", turn if number else np.eye(3)),
        (f"{name}, translation", pose[-3:] if number else np.zeros(3)),
        (int(width), int(height)) if width >= 1 and height >= 1 else None,
    )
    return FileCamera(camera)


def _parameters(element: Element) -> dict[str, str]:
    return {each.get("name", ""): each.get("value", "") for each in element.findall("Parameter")}


def _matrix(path: Path, name: str, values: dict[str, float]) -> Floats:
    if values["FS"] != 0.0:
        raise CameraError(
            f"{path}: {name}, FS = {values['FS']:g}: DICe says the skew is in degrees and uses it in pixels; set it to "
            "0 if it is small, or read the file of the program that calibrated."
        )
    return np.array([[values["FX"], 0.0, values["CX"]], [0.0, values["FY"], values["CY"]], [0.0, 0.0, 1.0]])


def _coefficients(path: Path, name: str, model: str, values: dict[str, float]) -> Floats:
    """Return the coefficients of the lens in OpenCV's order."""
    found = np.array([values.get(key, 0.0) for key in _ORDER])
    radial_only = np.isin(_ORDER, ("K1", "K2", "K3"))
    if model in _BROWN or (model in _RADIAL and not found[~radial_only].any()):
        return found
    if found.any() and model in _NONE:
        raise CameraError(f"{path}: {name} has coefficients of a lens, but no LENS_DISTORTION_MODEL.")
    if found.any():
        raise CameraError(
            f"{path}: {name}: the lens model {model} is not supported; those that are: {', '.join(_BROWN + _RADIAL)}. "
            "Its powers of the radius are not those of Brown's model. Calibrate with DICe's OpenCV model, or read the "
            "report of VIC-3D or the file of MatchID itself."
        )
    return found


def _pose(path: Path, name: str, element: Element) -> tuple[Floats, Floats, bool]:
    """Return rotation and translation, and whether they are there."""
    own = _parameters(element)
    shift = np.array([numbers(path, f"{name}, {key}", own.get(key, "0"), 1)[0] for key in _DISTANCES])
    matrix = next(
        (each for each in element.findall("ParameterList") if each.get("name") == "rotation_3x3_matrix"), None
    )
    angles = [numbers(path, f"{name}, {key}", own.get(key, "0"), 1)[0] for key in _ANGLES]
    posed = any(key in own for key in _ANGLES + _DISTANCES) or matrix is not None
    if matrix is None:
        return rotation_from_angles(*angles), shift, posed
    rows = _parameters(matrix)
    values = [_row(path, f"{name}, ROW {index}", rows.get(f"ROW {index}", ""), 3) for index in range(3)]
    return nearest_rotation(f"{path}: {name}, rotation_3x3_matrix", np.array(values)), shift, posed


def _row(path: Path, key: str, text: str, size: int) -> Floats:
    return numbers(path, key, re.sub(r"[{},]", " ", text), size)
