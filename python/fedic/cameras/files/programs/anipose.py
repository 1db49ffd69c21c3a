"""Cameras of Anipose (``calibration.toml``, of its ``aniposelib``)."""

from pathlib import Path
from typing import Any

from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.lens_models import check_no_other_lens
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.cameras.files.programs.opencv import size_of_image
from fedic.errors import CameraError

__all__ = ["anipose_camera", "is_anipose"]


def is_anipose(content: dict[str, Any]) -> bool:
    """Return true if the content of a TOML file is that of Anipose: tables of cameras with a matrix each."""
    return "model" not in content and bool(_cameras(content))


def anipose_camera(path: Path, content: dict[str, Any], number: int) -> FileCamera:
    """Return a camera, by its place in the file, with the rotation vector and translation that it has there."""
    cameras = _cameras(content)
    if not 0 <= number < len(cameras):
        raise CameraError(f"{path}: there is no camera {number}; the file holds {', '.join(cameras)}.")
    name = list(cameras)[number]
    table = cameras[name]
    if table.get("fisheye", False):
        raise CameraError(f"{path}: {name}.fisheye is true: a fisheye lens is not supported; calibrate as a pinhole.")
    size = {"image_size": table["size"]} if "size" in table else {}
    named = {
        key: (f"{name}.{key}", table[key])
        for key in ("matrix", "distortions", "rotation", "translation")
        if key in table
    }
    if "distortions" not in table:
        check_no_other_lens(path, {key: value for key, value in table.items() if key != "matrix"}, "distortions")
    posed = "rotation" in named and "translation" in named
    camera = camera_from_matrices(
        path,
        named["matrix"],
        named.get("distortions"),
        named.get("rotation"),
        named.get("translation"),
        size_of_image(path, size),
    )
    return FileCamera(camera, "" if posed or number == 0 else f"rotation or translation of {name} is missing.")


def _cameras(content: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {name: table for name, table in content.items() if isinstance(table, dict) and "matrix" in table}
