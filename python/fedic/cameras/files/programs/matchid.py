"""Cameras in the ``.caldat`` files of MatchID, with lines such as ``Cam1_Fx [pixels];7015.3``."""

import re
from pathlib import Path

from fedic._core import Pinhole
from fedic.cameras.files._stereo import stereo_camera
from fedic.errors import CameraError

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
_ANGLES, _DISTANCES = ("Theta", "Phi", "Psi"), ("Tx", "Ty", "Tz")
_CAMERA = re.compile(r"cam(\d+)_(.*)", re.IGNORECASE)


def read_matchid(path: Path, number: int) -> Pinhole:
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
    pose = [0.0] * 6 if number == 0 else [_required(path, values, key) for key in _ANGLES + _DISTANCES]
    return stereo_camera(path, number, intrinsics, (pose[0], pose[1], pose[2]), (pose[3], pose[4], pose[5]))


def _values(path: Path) -> dict[str, float]:
    """Return the numbers of the file by key, without the unit in brackets."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise CameraError(f"{path}: the camera file cannot be read ({error.strerror}).") from error
    values: dict[str, float] = {}
    for line in text.splitlines():
        key, semicolon, value = (part.strip() for part in line.partition(";"))
        if not semicolon:
            continue
        name = re.sub(r"\s*\[.*\]$", "", key)
        try:
            values[name] = float(value.rstrip(";"))
        except ValueError:
            raise CameraError(f"{path}: {key} = {value!r} is not a number; is the file truncated?") from None
    return values


def _required(path: Path, values: dict[str, float], key: str) -> float:
    if key not in values:
        raise CameraError(f"{path}: {key}, part of the pose of the second camera, is missing; is the file truncated?")
    return values[key]
