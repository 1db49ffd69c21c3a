"""Cameras of ROS: files of ``camera_calibration`` and messages ``sensor_msgs/CameraInfo`` that were printed."""

from pathlib import Path

import numpy as np

from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.lens_models import check_lens_model
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.cameras.files.programs.opencv import size_of_image
from fedic.cameras.files.syntax.tree import Tree, numbers, text_of
from fedic.errors import CameraError

__all__ = ["is_camera_info", "ros_camera"]

_MATRICES = ("D", "K", "R", "P")
_OTHERS = ("height", "width", "distortion_model", "binning_x", "binning_y", "roi")
_ROI = ("x_offset", "y_offset", "width", "height")


def is_camera_info(document: Tree) -> bool:
    """Return true if a YAML document is a printed message, with the names of ROS 1 or, in small letters, of ROS 2."""
    names = set(_message(document))
    return "K" in names and bool(names & {"P", "roi", "binning_x", "binning_y"})


def ros_camera(path: Path, documents: list[Tree], number: int) -> FileCamera:
    """Return the camera of the image that a message belongs to.

    K is the matrix of the full frame; a region of interest shifts it, binning then divides it, as ROS's
    ``image_geometry`` does. R and P describe rectified images and are no pose.

    Parameters
    ----------
    path : Path
        The file, for messages.
    documents : list of Tree
        The messages; all must describe the same camera.
    number : int
        Index of the camera: 0.

    Returns
    -------
    FileCamera
        The camera.

    Raises
    ------
    CameraError
        If a value is missing, wrong or not supported, or the messages differ.
    """
    if number != 0:
        raise CameraError(f"{path}: there is no camera {number}; a message of ROS describes one, number 0.")
    messages = [_message(document) for document in documents]
    message = messages[0]
    if any(other != message for other in messages[1:]):
        raise CameraError(f"{path}: the file holds {len(messages)} messages of different cameras; leave one in it.")
    check_lens_model(path, "distortion_model", text_of(message.get("distortion_model", "")))
    full = numbers(path, "K", message["K"], 9).reshape(3, 3)
    if not full.any():
        raise CameraError(f"{path}: K is zero: the driver of this camera has no calibration.")
    binning = [max(1, _count(path, message, name)) for name in ("binning_x", "binning_y")]
    roi = message.get("roi", {})
    left, top, width, height = (_count(path, roi, name) if isinstance(roi, dict) else 0 for name in _ROI)
    size = (width, height) if width and height else size_of_image(path, message)
    to_image = np.array([[1 / binning[0], 0, -left / binning[0]], [0, 1 / binning[1], -top / binning[1]], [0, 0, 1]])
    distortion = message.get("D")
    return FileCamera(
        camera_from_matrices(
            path,
            ("K", to_image @ full),
            None if distortion in (None, "", []) else ("D", distortion),
            image_size=None if size is None else (size[0] // binning[0], size[1] // binning[1]),
        )
    )


def _message(document: Tree) -> dict[str, Tree]:
    """Return the entries of a message that describe the camera, with the names of ROS 1."""
    if not isinstance(document, dict):
        return {}
    capital = {name.lower(): name for name in _MATRICES}
    named = {capital.get(key, key): value for key, value in document.items()}
    return {key: value for key, value in named.items() if key in (*_MATRICES, *_OTHERS)}


def _count(path: Path, tree: dict[str, Tree], key: str) -> int:
    value = numbers(path, key, tree.get(key, "0"), 1)[0]
    if value != int(value) or not 0 <= value < 2**31:
        raise CameraError(f"{path}: {key} = {value:g} should be a whole number, 0 or more.")
    return int(value)
