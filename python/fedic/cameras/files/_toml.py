"""Cameras in ``camera.toml``, with the keys of ``[camera]`` in the configuration of a run."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fedic._core import FrontParallel, ImageFrame, Pinhole
from fedic._internal.toml_files import read_tables
from fedic._internal.types import Camera
from fedic.cameras.lens_sections import lens_table
from fedic.cameras.schema import parse_camera
from fedic.errors import CameraError, ConfigError
from fedic.io.atomic import atomic_path

__all__ = ["read_toml", "write_toml"]

_HEADER = '# A camera for fedic; in the configuration of a run: [camera], file = "{name}".\n'


def read_toml(path: Path, number: int) -> Camera:
    """Read a camera; the section ``[calibration]`` is ignored."""
    if number != 0:
        raise CameraError(f"{path}: there is no camera {number}; the file holds one, number 0.")
    try:
        content = read_tables(path, "camera")
        content.pop("calibration", None)
        return parse_camera(path, content)
    except ConfigError as error:
        raise CameraError(error.message) from error


def write_toml(camera: Camera, path: Path, notes: Mapping[str, object]) -> None:
    """Write a camera, with notes in the section ``[calibration]``."""
    text = _HEADER.format(name=path.name) + _lines(_content(path, camera))
    lens = camera.distortion if isinstance(camera, Pinhole) else None
    if lens is not None:
        text += "\n[distortion]\n" + _lines(lens_table(lens))
    if notes:
        text += "\n# Uncertainty and origin, in pixels and radians; ignored on reading.\n[calibration]\n" + _lines(
            notes
        )
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _content(path: Path, camera: Camera) -> dict[str, object]:
    if isinstance(camera, ImageFrame):
        return {"model": "image-frame"}
    if isinstance(camera, FrontParallel):
        values = {"scale": camera.scale, "origin": list(camera.origin), "angle": camera.angle}
        return {"model": "front-parallel", **values}
    if isinstance(camera, Pinhole):
        return {
            "model": "pinhole",
            "focal": list(camera.focal),
            "principal_point": list(camera.principal_point),
            "rotation": np.asarray(camera.rotation).tolist(),
            "translation": list(camera.translation),
            "skew_angle": camera.skew_angle,
        }
    raise CameraError(f"{path}: a {type(camera).__name__} cannot be written as a camera.")


def _lines(content: Mapping[str, object]) -> str:
    return "".join(f"{key} = {_value(value)}\n" for key, value in content.items())


def _value(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    if isinstance(value, int):
        return str(value)
    return repr(float(value))  # type: ignore[arg-type]
