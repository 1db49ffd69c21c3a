"""Cameras in the calibration report that VIC-3D exports as text."""

import re
from pathlib import Path

from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.programs.measures import ANGLES, LENGTHS, PIXELS, Decimals, check_unit, split_unit
from fedic.cameras.files.programs.stereo import stereo_camera
from fedic.errors import CameraError

__all__ = ["vic3d_camera"]

_INTRINSICS = {
    "Center (X)": "cx",
    "Center (Y)": "cy",
    "Focal Length (X)": "fx",
    "Focal Length (Y)": "fy",
    "Skew": "fs",
    "Kappa 1": "k1",
    "Kappa 2": "k2",
    "Kappa 3": "k3",
}
_OPTIONAL = {"fs": 0.0, "k1": 0.0, "k2": 0.0, "k3": 0.0}
_KNOWN_LINES = ("Magnification",)
_HEADING = re.compile(r"Camera (\d+) intrinsics")


def vic3d_camera(path: Path, text: str, number: int) -> FileCamera:
    """Return one of the cameras of a report, given as its text.

    The frame of the second camera is ``X_1 = Rz Ry Rx X_0 + T``, as its magnifications imply; the report does not say.
    """
    sections = _sections(text)
    if not any(_HEADING.fullmatch(name) for name in sections):
        raise CameraError(
            f"{path}: no line 'Camera 0 intrinsics:'; is this a calibration report of VIC-3D? (Files of DICe and "
            "COLMAP begin with numbers.)"
        )
    heading = f"Camera {number} intrinsics"
    if heading not in sections:
        there = [name for name in sections if _HEADING.fullmatch(name)]
        raise CameraError(f"{path}: there is no camera {number}; the report holds {', '.join(there)}.")
    intrinsics, decimals = dict(_OPTIONAL) | {"d1": 0.0, "d2": 0.0}, Decimals(path)
    for key, (value, unit) in sections[heading].items():
        if key in _INTRINSICS:
            check_unit(path, key, unit, PIXELS)
            intrinsics[_INTRINSICS[key]] = _number(decimals, f"{heading}, {key}", value)
        elif not key.startswith(_KNOWN_LINES) and _number(decimals, f"{heading}, {key}", value) != 0.0:
            raise CameraError(f"{path}: {heading}: {key} = {value} is not in fedic's lens model.")
    for key, name in _INTRINSICS.items():
        if name not in intrinsics:
            raise CameraError(f"{path}: {heading}: {key} is missing; is the report truncated?")
    pose: dict[str, tuple[float, float, float]] = {}
    missing = ""
    for part, units in (("Angles", ANGLES), ("Distances", LENGTHS)) if number else ():
        lines = sections.get(part, {})
        absent = next((axis for axis in "XYZ" if axis not in lines), None)
        if absent is not None:
            missing = missing or f"Extrinsics, {part}: {absent} is missing; is the report truncated?"
        for axis in filter(lines.__contains__, "XYZ"):
            check_unit(path, f"{part}, {axis}", lines[axis][1], units)
        x, y, z = (_number(decimals, f"{part}, {axis}", lines.get(axis, ("0", ""))[0]) for axis in "XYZ")
        pose[part] = (x, y, z)
    nothing = (0.0, 0.0, 0.0)
    return stereo_camera(path, number, intrinsics, pose.get("Angles", nothing), pose.get("Distances", nothing), missing)


def _sections(text: str) -> dict[str, dict[str, tuple[str, str]]]:
    """Return the lines ``key [unit]: value`` under each heading ``name:``, value and unit by key."""
    sections: dict[str, dict[str, tuple[str, str]]] = {}
    lines: dict[str, tuple[str, str]] = {}
    for line in text.splitlines():
        key, colon, value = (part.strip() for part in line.partition(":"))
        if colon and not value:
            lines = sections.setdefault(key, {})
        elif colon:
            name, unit = split_unit(key)
            lines[name] = (value, unit)
    return sections


def _number(decimals: Decimals, key: str, value: str) -> float:
    """Return the value of a text such as ``12.3 +/- 0.4``."""
    return decimals.number(key, value.split("+/-")[0].strip())
