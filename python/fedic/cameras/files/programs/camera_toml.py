"""Cameras in ``camera.toml``, with the keys of ``[camera]`` in the configuration of a run."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fedic._core import FrontParallel, ImageFrame, Pinhole
from fedic._internal.types import Camera
from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.programs.anipose import anipose_camera, is_anipose
from fedic.cameras.lens_sections import lens_table
from fedic.cameras.schema import parse_camera
from fedic.errors import CameraError, ConfigError, OptionError
from fedic.io.atomic import atomic_path
from fedic.io.toml import load_toml, parse_toml

__all__ = ["camera_from_text", "camera_text", "read_toml", "write_toml"]

_HEADER = "# A camera for fedic; in the configuration of a run: [camera], file = {name}.\n"
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\b": "\\b", "\t": "\\t", "\n": "\\n", "\f": "\\f", "\r": "\\r"}


def read_toml(path: Path, number: int) -> FileCamera:
    """Read a camera; the section ``[calibration]`` is ignored."""
    content = load_toml(path, CameraError, "camera")
    if is_anipose(content):
        return anipose_camera(path, content, number)
    if number != 0:
        raise CameraError(f"{path}: there is no camera {number}; the file holds one, number 0.")
    content.pop("calibration", None)
    try:
        return FileCamera(parse_camera(path, content))
    except ConfigError as error:
        raise CameraError(error.message) from error


def camera_from_text(text: str, path: Path) -> Camera:
    """Return the camera of a text of `camera_text`."""
    return parse_camera(path, parse_toml(text))


def write_toml(camera: Camera, path: Path, notes: Mapping[str, object]) -> None:
    """Write a camera, with notes in the section ``[calibration]``."""
    text = _HEADER.format(name=_text(path.name)) + camera_text(camera, path)
    if notes:
        text += "\n# Uncertainty and origin, in pixels and radians; ignored on reading.\n[calibration]\n" + _lines(
            path, notes
        )
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def camera_text(camera: Camera, path: Path) -> str:
    """Return the keys of a camera as TOML; `path` names the file in messages."""
    text = _lines(path, _content(path, camera))
    lens = camera.distortion if isinstance(camera, Pinhole) else None
    return text if lens is None else text + "\n[distortion]\n" + _lines(path, lens_table(lens))


def _content(path: Path, camera: Camera) -> dict[str, object]:
    if not isinstance(camera, ImageFrame | FrontParallel | Pinhole):
        raise CameraError(f"{path}: a {type(camera).__name__} cannot be written as a camera.")
    size = {} if camera.image_size is None else {"image_size": list(camera.image_size)}
    if isinstance(camera, ImageFrame):
        return {"model": "image-frame", **size, "scale": camera.scale, "origin": list(camera.origin)}
    if isinstance(camera, FrontParallel):
        values = {"scale": camera.scale, "origin": list(camera.origin), "angle": camera.angle}
        return {"model": "front-parallel", **size, **values}
    return {
        "model": "pinhole",
        **size,
        "focal": list(camera.focal),
        "principal_point": list(camera.principal_point),
        "rotation": np.asarray(camera.rotation).tolist(),
        "translation": list(camera.translation),
        "skew_angle": camera.skew_angle,
    }


def _lines(path: Path, content: Mapping[str, object]) -> str:
    return "".join(f"{_key(str(key))} = {_value(path, str(key), value)}\n" for key, value in content.items())


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _text(key)


def _value(path: Path, key: str, value: object) -> str:
    if isinstance(value, list | tuple | np.ndarray):
        return f"[{', '.join(_value(path, key, each) for each in value)}]"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, int | np.integer):
        return str(int(value))
    if isinstance(value, float | np.floating):
        return repr(float(value))
    raise OptionError(f"{path}: notes: {key} is a {type(value).__name__}; give numbers and texts.", "notes")


def _text(text: str) -> str:
    """Return a basic string of TOML; what is no character, as in file names of odd bytes, becomes U+FFFD."""
    return f'"{"".join(map(_character, text))}"'


def _character(character: str) -> str:
    code = ord(character)
    if 0xD800 <= code <= 0xDFFF:
        return "\ufffd"
    return _ESCAPES.get(character) or (f"\\u{code:04x}" if code < 0x20 or code == 0x7F else character)
