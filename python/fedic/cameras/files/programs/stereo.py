"""Cameras of a stereo calibration, with the pose of the second relative to the first."""

from pathlib import Path

import numpy as np

from fedic._core import BrownDistortion, Pinhole
from fedic._internal.types import Floats
from fedic.cameras.files.file_camera import FileCamera
from fedic.errors import CameraError

__all__ = ["rotation_from_angles", "stereo_camera"]


def rotation_from_angles(x: float, y: float, z: float) -> Floats:
    """Return the rotation matrix of angles in degrees about fixed axes, X first: ``Rz Ry Rx``.

    Parameters
    ----------
    x, y, z : float
        Angles in degrees.

    Returns
    -------
    ndarray, shape (3, 3)
        The rotation.
    """
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians([x, y, z])), np.sin(np.radians([x, y, z]))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x, dtype=np.float64)


def stereo_camera(
    path: Path,
    number: int,
    intrinsics: dict[str, float],
    angles: tuple[float, float, float],
    distances: tuple[float, float, float],
    missing_pose: str = "",
) -> FileCamera:
    """Make one of two cameras; the world is the frame of the first.

    Parameters
    ----------
    path : Path
        The file, for messages.
    number : int
        Index of the camera, 0 or 1.
    intrinsics : dict of str to float
        Values of ``fx fy fs cx cy k1 k2 k3 d1 d2``.
    angles, distances : (float, float, float)
        Rotation and translation from the frame of the first camera to that of the second, in degrees and in the file's
        unit of length.
    missing_pose : str
        What the file lacks of the pose of the second camera, see `FileCamera`.

    Returns
    -------
    FileCamera
        The camera.

    Raises
    ------
    CameraError
        If the values are not those of a camera.
    """
    posed = number > 0 and not missing_pose
    fx, fs = intrinsics["fx"], intrinsics["fs"]
    angle = float(np.arctan2(fx, fs)) if fs else np.pi / 2
    k1, k2, k3, d1, d2 = (intrinsics[name] for name in ("k1", "k2", "k3", "d1", "d2"))
    try:
        lens = BrownDistortion((k1, k2, k3), (d1, d2))
        camera = Pinhole(
            (fx, intrinsics["fy"] * float(np.sin(angle))),
            (intrinsics["cx"], intrinsics["cy"]),
            rotation=rotation_from_angles(*angles) if posed else None,
            translation=distances if posed else (0.0, 0.0, 0.0),
            skew_angle=angle,
            distortion=lens,
        )
    except CameraError as error:
        raise CameraError(f"{path}: camera {number}: {error}") from None
    return FileCamera(camera, missing_pose)
