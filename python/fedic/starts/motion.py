"""Motions of the image plane as 3 x 3 matrices: affine maps and homographies, in pixels."""

import numpy as np

from fedic._internal.types import Floats

__all__ = ["affine", "is_plausible", "moved", "translation"]

_LARGEST_STRETCH = 4.0


def affine(rows: Floats) -> Floats:
    """Return the matrix of the affine map given by its first two rows, shape (2, 3)."""
    return np.vstack([np.asarray(rows, dtype=np.float64), [0.0, 0.0, 1.0]])


def translation(shift: Floats) -> Floats:
    """Return the matrix of a translation by (u, v)."""
    matrix = np.eye(3)
    matrix[:2, 2] = shift
    return matrix


def moved(motion: Floats, points: Floats) -> Floats:
    """Return the places of points, shape (n, 2), after a motion."""
    homogeneous = points @ motion[:, :2].T + motion[:, 2]
    places: Floats = homogeneous[:, :2] / homogeneous[:, 2:]
    return places


def is_plausible(motion: Floats, corners: Floats) -> bool:
    """Tell whether a motion keeps the orientation and stretches by at most 4 at each of the corners of a region."""
    if not np.isfinite(motion).all():
        return False
    depth = corners @ motion[2, :2] + motion[2, 2]
    if (depth <= 0.0).any():
        return False
    places = moved(motion, corners)
    gradients = (motion[:2, :2] - places[:, :, np.newaxis] * motion[2, :2]) / depth[:, np.newaxis, np.newaxis]
    stretches = np.linalg.svd(gradients, compute_uv=False)
    return bool(
        (np.linalg.det(gradients) > 0.0).all()
        and (stretches <= _LARGEST_STRETCH).all()
        and (stretches >= 1.0 / _LARGEST_STRETCH).all()
    )
