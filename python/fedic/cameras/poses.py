"""Poses of pinhole cameras: of flat points, and of a camera moved elsewhere."""

import numpy as np

from fedic._core import Pinhole
from fedic._internal.types import Floats

__all__ = ["flat_poses", "posed"]


def flat_poses(points: Floats, pixels: Floats, matrix: Floats) -> list[tuple[Floats, Floats]]:
    """Return the poses from which a plane of points is nearly seen at some pixels, without distortion.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        At least four, with Z = 0.
    pixels : ndarray, shape (n, 2)
        Where they are seen.
    matrix : ndarray, shape (3, 3)
        Intrinsic matrix.

    Returns
    -------
    list of (ndarray (3,), ndarray (3,))
        Rotation vector and translation of the one or two poses there are (Collins and Bartoli, 2014); none where the
        points allow none.
    """
    import cv2

    try:
        count, turns, places, _ = cv2.solvePnPGeneric(points, pixels, matrix, None, flags=cv2.SOLVEPNP_IPPE)
    except cv2.error:
        return []
    found = [
        (np.asarray(turn, dtype=np.float64).ravel(), np.asarray(place, dtype=np.float64).ravel())
        for turn, place in zip(turns[:count], places[:count], strict=True)
    ]
    return [pose for pose in found if np.isfinite(pose).all()]


def posed(camera: Pinhole, rotation: Floats, translation: Floats) -> Pinhole:
    """Return a pinhole camera with another pose: rotation (3,) or (3, 3) and translation (3,)."""
    tx, ty, tz = (float(value) for value in translation)
    return Pinhole(
        camera.focal,
        camera.principal_point,
        rotation=rotation,
        translation=(tx, ty, tz),
        skew_angle=camera.skew_angle,
        distortion=camera.distortion,
    )
