"""Rotation matrices as files print them: with few digits."""

import warnings

import numpy as np

from fedic._internal.types import Floats
from fedic._internal.warning_level import levels_within_fedic
from fedic.errors import CalibrationWarning, CameraError

__all__ = ["nearest_rotation"]

_EXACT = 1e-12
_SILENT = 1e-6
"""Largest change of an entry without a warning: what six printed decimals leave."""
_LARGEST = 1e-3
"""Largest change of an entry: a matrix further off was not rounded, but is none."""


def nearest_rotation(where: str, matrix: Floats) -> Floats:
    """Return the rotation nearest to a matrix that was printed with few digits.

    Parameters
    ----------
    where : str
        File and key, for messages.
    matrix : ndarray, shape (3, 3)
        The matrix.

    Returns
    -------
    ndarray, shape (3, 3)
        The matrix itself if it is a rotation to rounding, else the nearest rotation.

    Raises
    ------
    CameraError
        If an entry of the matrix is more than 0.001 from that of the nearest rotation, or the matrix is a reflection.

    Warns
    -----
    CalibrationWarning
        If an entry is more than 1e-6 from that of the nearest rotation.
    """
    matrix = np.asarray(matrix, dtype=np.float64)
    if not np.isfinite(matrix).all():
        raise CameraError(f"{where} holds NaN or infinite numbers.")
    if np.abs(matrix @ matrix.T - np.eye(3)).max() <= _EXACT and np.linalg.det(matrix) > 0.0:
        return matrix
    left, _, right = np.linalg.svd(matrix)
    nearest: Floats = left @ right
    deviation = float(np.abs(matrix - nearest).max())
    if deviation > _LARGEST:
        raise CameraError(
            f"{where} is not a rotation: an entry is {deviation:.1e} from that of the nearest rotation, more than "
            "rounded digits explain. Give an orthonormal matrix or a rotation vector."
        )
    if np.linalg.det(nearest) < 0.0:
        raise CameraError(
            f"{where} is a reflection, not a rotation: its determinant is -1. Fedic's camera frame is right-handed, "
            "x to the right, y down, z forward; change the sign of one axis of the world."
        )
    if deviation > _SILENT:
        warnings.warn(
            f"{where} is a rotation to {deviation:.0e} only, and the nearest rotation is taken: copy it with more "
            "digits.",
            CalibrationWarning,
            stacklevel=levels_within_fedic(),
        )
    return nearest
