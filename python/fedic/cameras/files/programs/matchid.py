"""Cameras in the ``.caldat`` files of MatchID, with lines such as ``Cam1_Fx [pixels];7015.3``."""

import math
import re
from pathlib import Path

from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.programs.measures import ANGLES, LENGTHS, PIXELS, Decimals, check_unit, split_unit
from fedic.cameras.files.programs.stereo import stereo_camera
from fedic.cameras.files.syntax.tree import LARGEST_FILE
from fedic.errors import CameraError
from fedic.io.text import read_text

__all__ = ["read_matchid"]

_INTRINSICS = {
    "Fx": "fx",
    "Fy": "fy",
    "Fs": "fs",
    "Cx": "cx",
    "Cy": "cy",
    "Kappa 1": "k1",
    "Kappa 2": "k2",
    "Kappa 3": "k3",
    "P1": "d1",
    "P2": "d2",
}
_REQUIRED = ("Fx", "Fy", "Cx", "Cy")
_IN_PIXELS = ("_Fx", "_Fy", "_Fs", "_Cx", "_Cy")
_ANGLES, _DISTANCES = ("Theta", "Phi", "Psi"), ("Tx", "Ty", "Tz")
_CAMERA = re.compile(r"cam(\d+)_(.*)", re.IGNORECASE)


def read_matchid(path: Path, number: int) -> FileCamera:
    """Read one of the cameras of a file; those of a pair are named Cam0 and Cam1, or Cam1 and Cam2."""
    values = _values(path)
    numbered = [(int(match[1]), match[2], value) for key, value in values.items() if (match := _CAMERA.fullmatch(key))]
    cameras = sorted({number for number, _, _ in numbered})
    if not cameras:
        raise CameraError(f"{path}: no key such as 'Cam1_Fx [pixels]'; is this a calibration file of MatchID?")
    if not 0 <= number < len(cameras):
        names = ", ".join(f"Cam{number}" for number in cameras)
        raise CameraError(
            f"{path}: there is no camera {number}; the file holds {len(cameras)}, counted from 0: {names}."
        )
    prefix = f"Cam{cameras[number]}_"
    own = {key: value for each, key, value in numbered if each == cameras[number]}
    for key in _REQUIRED:
        if key not in own:
            raise CameraError(f"{path}: {prefix}{key} is missing; is the file truncated?")
    for key, value in own.items():
        if key not in _INTRINSICS and value != 0.0:
            raise CameraError(f"{path}: {prefix}{key} = {value:g} is not in fedic's lens model.")
    intrinsics = {name: own.get(key, 0.0) for key, name in _INTRINSICS.items()}
    missing = [key for key in _ANGLES + _DISTANCES if key not in values] if number else []
    sentence = (
        f"{missing[0]}, part of the pose of the second camera, is missing; is the file truncated?" if missing else ""
    )
    pose = [0.0] * 6 if number == 0 or missing else [values[key] for key in _ANGLES + _DISTANCES]
    return stereo_camera(path, number, intrinsics, (pose[0], pose[1], pose[2]), (pose[3], pose[4], pose[5]), sentence)


def _values(path: Path) -> dict[str, float]:
    """Return the numbers of the file by key, without the unit in brackets, which is checked."""
    values: dict[str, float] = {}
    decimals = Decimals(path)
    for line in read_text(path, LARGEST_FILE, CameraError).splitlines():
        key, semicolon, value = (part.strip() for part in line.partition(";"))
        if not semicolon:
            continue
        name, unit = split_unit(key)
        if name in values:
            raise CameraError(f"{path}: the key {name} is there twice; which one counts?")
        if name in _ANGLES:
            check_unit(path, name, unit, ANGLES)
        elif name in _DISTANCES:
            check_unit(path, name, unit, LENGTHS)
        elif name.endswith(_IN_PIXELS):
            check_unit(path, name, unit, PIXELS)
        values[name] = decimals.number(key, value.rstrip("; "))
        if not math.isfinite(values[name]):
            raise CameraError(f"{path}: {key} = {value} is not a finite number.")
    return values
