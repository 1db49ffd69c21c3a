"""Cameras in the calibration report that VIC-3D exports as text."""

import re
from pathlib import Path

from fedic._core import Pinhole
from fedic.cameras.files._stereo import stereo_camera
from fedic.errors import CameraError

__all__ = ["read_vic3d"]

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


def read_vic3d(path: Path, number: int) -> Pinhole:
    """Read one of the cameras of a report.

    The frame of the second camera is ``X_1 = Rz Ry Rx X_0 + T``, as its magnifications imply; the report does not say.
    """
    sections = _sections(path)
    if not any(_HEADING.fullmatch(name) for name in sections):
        raise CameraError(f"{path}: no line 'Camera 0 intrinsics:'; is this a calibration report of VIC-3D?")
    heading = f"Camera {number} intrinsics"
    if heading not in sections:
        there = [name for name in sections if _HEADING.fullmatch(name)]
        raise CameraError(f"{path}: there is no camera {number}; the report holds {', '.join(there)}.")
    intrinsics = dict(_OPTIONAL) | {"d1": 0.0, "d2": 0.0}
    for key, value in sections[heading].items():
        if key in _INTRINSICS:
            intrinsics[_INTRINSICS[key]] = _number(path, f"{heading}, {key}", value)
        elif not key.startswith(_KNOWN_LINES) and _number(path, f"{heading}, {key}", value) != 0.0:
            raise CameraError(f"{path}: {heading}: {key} = {value} is not in fedic's lens model.")
    for key, name in _INTRINSICS.items():
        if name not in intrinsics:
            raise CameraError(f"{path}: {heading}: {key} is missing; is the report truncated?")
    angles, distances = (
        ((0.0, 0.0, 0.0),) * 2
        if number == 0
        else (_triple(path, sections, "Angles"), _triple(path, sections, "Distances"))
    )
    return stereo_camera(path, number, intrinsics, angles, distances)


def _sections(path: Path) -> dict[str, dict[str, str]]:
    """Return the lines ``key: value`` under each heading ``name:``."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise CameraError(f"{path}: the camera file cannot be read ({error.strerror}).") from error
    sections: dict[str, dict[str, str]] = {}
    lines: dict[str, str] = {}
    for line in text.splitlines():
        key, colon, value = (part.strip() for part in line.partition(":"))
        if colon and not value:
            lines = sections.setdefault(key, {})
        elif colon:
            lines[re.sub(r"\s*\[.*\]$", "", key)] = value
    return sections


def _triple(path: Path, sections: dict[str, dict[str, str]], heading: str) -> tuple[float, float, float]:
    lines = sections.get(heading, {})
    missing = next((axis for axis in "XYZ" if axis not in lines), None)
    if missing is not None:
        raise CameraError(f"{path}: Extrinsics, {heading}: {missing} is missing; is the report truncated?")
    x, y, z = (_number(path, f"{heading}, {axis}", lines[axis]) for axis in "XYZ")
    return x, y, z


def _number(path: Path, key: str, value: str) -> float:
    """Return the value of a text such as ``12.3 +/- 0.4``."""
    try:
        return float(value.split("+/-")[0])
    except ValueError:
        raise CameraError(f"{path}: {key} = {value!r} is not a number.") from None
