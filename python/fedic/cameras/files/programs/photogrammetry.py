"""Cameras of photogrammetry: COLMAP (``cameras.txt``) and Agisoft Metashape (XML)."""

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.cameras.files.syntax.tree import numbers
from fedic.errors import CameraError

__all__ = ["colmap_camera", "is_colmap", "metashape_camera"]

_COLMAP = {
    "SIMPLE_PINHOLE": ("f", "cx", "cy"),
    "PINHOLE": ("fx", "fy", "cx", "cy"),
    "SIMPLE_RADIAL": ("f", "cx", "cy", "k1"),
    "RADIAL": ("f", "cx", "cy", "k1", "k2"),
    "OPENCV": ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"),
    "FULL_OPENCV": ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
}
"""Parameters of each model of COLMAP that is a pinhole with Brown's lens."""
_CORNER = 0.5
"""Both programs have their origin at the corner of the first pixel, fedic at its centre."""


def is_colmap(text: str) -> bool:
    """Return true if a text has lines of COLMAP: number, model, width, height, parameters."""
    rows = _rows(text)
    return bool(rows) and all(len(row) > 4 and row[1].isupper() and row[2].isdigit() for row in rows)


def colmap_camera(path: Path, text: str, number: int) -> FileCamera:
    """Return a camera, by its place in the file; the poses are in another file of COLMAP."""
    rows = _rows(text)
    if not 0 <= number < len(rows):
        raise CameraError(f"{path}: there is no camera {number}; the file holds {len(rows)}, counted from 0.")
    _, model, width, height, *values = rows[number]
    if model not in _COLMAP:
        raise CameraError(
            f"{path}: the camera model {model} is not supported; those that are: {', '.join(_COLMAP)}. "
            "Undistort with COLMAP, or calibrate with OPENCV."
        )
    found = dict(zip(_COLMAP[model], numbers(path, model, values, len(_COLMAP[model])), strict=True))
    fx, fy = found.get("fx", found.get("f", 0.0)), found.get("fy", found.get("f", 0.0))
    matrix = np.array([[fx, 0, found["cx"] - _CORNER], [0, fy, found["cy"] - _CORNER], [0, 0, 1]])
    lens = np.array([found.get(key, 0.0) for key in ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")])
    size = numbers(path, "width and height", [width, height], 2)
    camera = camera_from_matrices(path, (model, matrix), (model, lens), image_size=(int(size[0]), int(size[1])))
    return FileCamera(
        camera, "the pose of a second camera is missing: COLMAP writes poses into images.txt." if number else ""
    )


def metashape_camera(path: Path, root: Element, number: int) -> FileCamera:
    """Return the camera of an exported calibration, ``<calibration>``.

    ``u = w/2 + cx + f x + b1 x + b2 y``, ``v = h/2 + cy + f y``; p1 and p2 are OpenCV's p2 and p1.
    """
    if number != 0:
        raise CameraError(f"{path}: there is no camera {number}; a calibration of Metashape describes one, number 0.")
    projection = (root.findtext("projection") or "frame").strip()
    if projection != "frame":
        raise CameraError(f"{path}: projection = {projection!r} is not supported, only 'frame'.")
    given = {child.tag: child.text or "" for child in root}
    value = {key: float(numbers(path, key, given.get(key, "0"), 1)[0]) for key in _METASHAPE}
    for key in ("f", "width", "height"):
        if value[key] <= 0.0:
            raise CameraError(f"{path}: {key} is missing or not positive.")
    if value["k4"] or value["p3"] or value["p4"]:
        raise CameraError(f"{path}: k4, p3 or p4 is not zero, and not in Brown's model; calibrate again without them.")
    size = (int(value["width"]), int(value["height"]))
    matrix = np.array(
        [
            [value["f"] + value["b1"], value["b2"], size[0] / 2 + value["cx"] - _CORNER],
            [0, value["f"], size[1] / 2 + value["cy"] - _CORNER],
            [0, 0, 1],
        ]
    )
    lens = np.array([value[key] for key in ("k1", "k2", "p2", "p1", "k3")])
    return FileCamera(camera_from_matrices(path, ("calibration", matrix), ("calibration", lens), image_size=size))


_METASHAPE = ("width", "height", "f", "cx", "cy", "b1", "b2", "k1", "k2", "k3", "k4", "p1", "p2", "p3", "p4")


def _rows(text: str) -> list[list[str]]:
    lines = (line.split("#")[0].split() for line in text.splitlines())
    return [line for line in lines if line]
