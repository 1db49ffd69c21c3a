"""Conversion between cameras and OpenCV's matrices."""

from pathlib import Path

import numpy as np

from fedic._core import BrownDistortion, Pinhole
from fedic._internal.types import Floats
from fedic.cameras.files.syntax.tree import Tree, numbers
from fedic.cameras.rotations import nearest_rotation
from fedic.errors import CameraError

__all__ = ["camera_from_matrices", "matrices_of_camera"]

_LENGTHS = (4, 5, 8, 12, 14)
_BEYOND = {"k4": 5, "k5": 6, "k6": 7, "s2": 9, "s4": 11, "tau_x": 12, "tau_y": 13}


def camera_from_matrices(
    path: Path,
    matrix: tuple[str, Tree],
    distortion: tuple[str, Tree] | None = None,
    rotation: tuple[str, Tree] | None = None,
    translation: tuple[str, Tree] | None = None,
    image_size: tuple[int, int] | None = None,
) -> Pinhole:
    """Make a camera from OpenCV's matrices, each given with its key in the file.

    Parameters
    ----------
    path : Path
        The file, for messages.
    matrix : (str, Tree)
        Camera matrix of nine numbers.
    distortion : (str, Tree), optional
        4, 5, 8, 12 or 14 coefficients in OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y.
    rotation, translation : (str, Tree), optional
        Rotation vector or matrix, and translation: both or none.
    image_size : (int, int), optional
        Width and height in pixels.

    Returns
    -------
    Pinhole
        The camera.

    Raises
    ------
    CameraError
        If a matrix has the wrong size, or values that a `fedic.Pinhole` cannot represent.
    """
    k = numbers(path, *matrix, size=9).reshape(3, 3)
    if k[1, 0] != 0.0 or not np.array_equal(k[2], [0.0, 0.0, 1.0]):
        raise CameraError(
            f"{path}: {matrix[0]} is not a camera matrix [[fx, s, cx], [0, fy, cy], [0, 0, 1]]: {k.tolist()}."
        )
    lens = None if distortion is None else _lens(path, *distortion)
    turn = None if rotation is None else _rotation(path, *rotation)
    tx, ty, tz = np.zeros(3) if translation is None else numbers(path, *translation, size=3)
    if (rotation is None) != (translation is None):
        there, absent = (rotation, "translation") if translation is None else (translation, "rotation")
        raise CameraError(
            f"{path}: {there[0] if there else ''} is there, but no {absent}: a pose has both. Add the {absent}, or "
            "leave the other out if it is not part of the pose."
        )
    try:
        angle = float(np.arctan2(k[0, 0], k[0, 1]))
        return Pinhole(
            (k[0, 0], k[1, 1] * np.sin(angle)),
            (k[0, 2], k[1, 2]),
            rotation=turn,
            translation=(tx, ty, tz),
            skew_angle=angle if k[0, 1] != 0.0 else np.pi / 2,
            distortion=lens,
            image_size=image_size,
        )
    except CameraError as error:
        raise CameraError(f"{path}: {matrix[0]}: {error}") from None


def matrices_of_camera(path: Path, camera: object) -> tuple[Floats, Floats, Floats, Floats]:
    """Return camera matrix, the 5 or 12 coefficients of OpenCV, rotation matrix and translation of a camera.

    Raises
    ------
    CameraError
        If OpenCV cannot represent the camera.
    """
    if not isinstance(camera, Pinhole):
        raise CameraError(
            f"{path}: OpenCV's files can hold a Pinhole only, not a {type(camera).__name__}; write .toml."
        )
    if not np.isclose(camera.skew_angle, np.pi / 2, rtol=0.0, atol=1e-15):
        raise CameraError(f"{path}: OpenCV ignores the skew of the camera ({camera.skew_angle} rad); write .toml.")
    lens = camera.distortion
    if lens is not None and not isinstance(lens, BrownDistortion):
        raise CameraError(
            f"{path}: OpenCV's files can hold a BrownDistortion only, not a {type(lens).__name__}; write .toml."
        )
    (k1, k2, k3), (d1, d2), (p1, p2) = (
        ((0.0, 0.0, 0.0), (0.0, 0.0), (0.0, 0.0)) if lens is None else (lens.radial, lens.decentering, lens.prism)
    )
    (fx, fy), (cx, cy) = camera.focal, camera.principal_point
    coefficients = [k1, k2, d1, d2, k3]
    if p1 or p2:
        coefficients += [0.0, 0.0, 0.0, p1, 0.0, p2, 0.0]
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return matrix, np.array([coefficients]), camera.rotation, np.array(camera.translation)


def _rotation(path: Path, key: str, values: Tree) -> Floats:
    """Return a rotation vector, or the rotation nearest to a matrix."""
    turn = numbers(path, key, values)
    if turn.size not in (3, 9):
        raise CameraError(f"{path}: {key} holds {turn.size} numbers, not 3 or 9.")
    return turn if turn.size == 3 else nearest_rotation(f"{path}: {key}", turn.reshape(3, 3))


def _lens(path: Path, key: str, values: Tree) -> BrownDistortion | None:
    found = numbers(path, key, values)
    if found.size == 0 or not found.any():
        return None
    if found.size not in _LENGTHS:
        raise CameraError(f"{path}: {key} holds {found.size} coefficients; OpenCV writes 4, 5, 8, 12 or 14.")
    full = np.zeros(max(_LENGTHS))
    full[: found.size] = found
    beyond = [f"{name} = {full[place]:g}" for name, place in _BEYOND.items() if full[place] != 0.0]
    if beyond:
        raise CameraError(
            f"{path}: {key} has {', '.join(beyond)}: the rational and tilted models and the prism terms in r^4 are not "
            "supported; calibrate again without them."
        )
    k1, k2, d1, d2, k3 = (float(value) for value in full[:5])
    return BrownDistortion((k1, k2, k3), (d1, d2), (float(full[8]), float(full[10])))
