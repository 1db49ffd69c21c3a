"""Poses of pinhole cameras."""

import numpy as np

from fedic._core import Pinhole
from fedic._internal.types import Floats

__all__ = ["flat_poses", "with_pose"]


def flat_poses(points: Floats, pixels: Floats, matrix: Floats) -> list[tuple[Floats, Floats]]:
    """Return the poses that fit coplanar points without distortion (Collins and Bartoli, 2014).

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        At least four points with Z = 0.
    pixels : ndarray, shape (n, 2)
        Their image points.
    matrix : ndarray, shape (3, 3)
        Intrinsic matrix.

    Returns
    -------
    list of (ndarray (3,), ndarray (3,))
        Rotation vector and translation of one or two poses; empty if the points determine none.
    """
    import cv2

    try:
        count, rotations, translations, _ = cv2.solvePnPGeneric(points, pixels, matrix, None, flags=cv2.SOLVEPNP_IPPE)
    except cv2.error:
        return []
    found = [
        (np.asarray(rotation, dtype=np.float64).ravel(), np.asarray(translation, dtype=np.float64).ravel())
        for rotation, translation in zip(rotations[:count], translations[:count], strict=True)
    ]
    return [pose for pose in found if np.isfinite(pose).all()]


def with_pose(camera: Pinhole, rotation: Floats, translation: Floats) -> Pinhole:
    """Return a pinhole camera with another pose: rotation (3,) or (3, 3) and translation (3,)."""
    tx, ty, tz = (float(value) for value in translation)
    return Pinhole(
        camera.focal,
        camera.principal_point,
        rotation=rotation,
        translation=(tx, ty, tz),
        skew_angle=camera.skew_angle,
        distortion=camera.distortion,
        image_size=camera.image_size,
    )
