"""Cameras in the project files of VIC-3D (XML with an element ``<calibration>``)."""

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from fedic._internal.types import Floats
from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.cameras.files.programs.stereo import rotation_from_angles
from fedic.cameras.files.syntax.tree import numbers
from fedic.errors import CameraError

__all__ = ["vic3d_project_camera"]

_VALUES = ("cx", "cy", "fx", "fy", "fs", "k1", "k2", "k3")


def vic3d_project_camera(path: Path, root: Element, number: int) -> FileCamera:
    """Return a camera; the world is the frame of the first.

    The orientation of each camera, three angles in degrees and a translation, is ``X_c = Rz Ry Rx X + T`` in a world of
    VIC-3D's: from two of them follows the relative pose that its report prints.
    """
    calibration = root if root.tag == "calibration" else root.find("calibration")
    cameras = [] if calibration is None else calibration.findall("camera")
    numbered = {each.get("id", str(index)): each for index, each in enumerate(cameras)}
    if str(number) not in numbered:
        raise CameraError(f"{path}: there is no camera {number}; the file holds {', '.join(numbered) or 'none'}.")
    camera, first = numbered[str(number)], numbered.get("0")
    key = f"camera {number}"
    value = dict(zip(_VALUES, numbers(path, key, camera.text or "", len(_VALUES)), strict=True))
    turn: Floats = np.eye(3)
    shift: Floats = np.zeros(3)
    missing = ""
    if number:
        absent = [name for name, each in (("0", first), (str(number), camera)) if each is None or not _has_pose(each)]
        missing = f"the orientation of camera {' and '.join(absent)} is missing." if absent else ""
        if first is not None and not absent:
            (first_turn, first_shift), (own_turn, own_shift) = _pose(path, "camera 0", first), _pose(path, key, camera)
            turn = own_turn @ first_turn.T
            shift = own_shift - turn @ first_shift
    found = camera_from_matrices(
        path,
        (key, np.array([[value["fx"], value["fs"], value["cx"]], [0, value["fy"], value["cy"]], [0, 0, 1]])),
        (key, np.array([value["k1"], value["k2"], 0.0, 0.0, value["k3"]])),
        (f"{key}, orientation", turn),
        (f"{key}, orientation", shift),
        _size(path, root),
    )
    return FileCamera(found, missing)


def _has_pose(camera: Element) -> bool:
    return camera.find("orientation") is not None


def _pose(path: Path, key: str, camera: Element) -> tuple[Floats, Floats]:
    values = numbers(path, f"{key}, orientation", camera.findtext("orientation") or "", 6)
    return rotation_from_angles(*values[:3]), values[3:]


def _size(path: Path, root: Element) -> tuple[int, int] | None:
    """Return the size of the images, which the areas of interest have; None if they differ."""
    sizes = {
        tuple(int(numbers(path, f"polygonmask, {name}", mask.get(name, "0"), 1)[0]) for name in ("width", "height"))
        for mask in root.iter("polygonmask")
    }
    if len(sizes) != 1:
        return None
    width, height = sizes.pop()
    return (width, height) if width > 0 and height > 0 else None
