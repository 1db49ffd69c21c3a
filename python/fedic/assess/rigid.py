"""The rigid motion in a field of displacements in the plane."""

from typing import NamedTuple

import numpy as np

from fedic._internal.types import Floats

__all__ = ["RigidMotion", "fit_rigid_motion"]


class RigidMotion(NamedTuple):
    """A rigid motion fitted to a field, and what it leaves.

    Attributes
    ----------
    translation : ndarray, shape (2,)
        Displacement of the centre of the points.
    rotation : float
        Angle in radians, counter-clockwise from x to y.
    residual : ndarray, shape (n, 2)
        Displacement without the rigid motion.
    """

    translation: Floats
    rotation: float
    residual: Floats


def fit_rigid_motion(points: Floats, displacement: Floats) -> RigidMotion:
    """Fit a translation and a rotation of any size by least squares.

    Parameters
    ----------
    points, displacement : ndarray, shape (n, 2)
        Positions and displacements, two of them or more, without NaN.

    Returns
    -------
    RigidMotion
        The motion that minimises the sum of the squared residuals (the plane case of W. Kabsch, *Acta Cryst.* A32,
        1976).
    """
    before = points - points.mean(axis=0)
    moved = points + displacement
    after = moved - moved.mean(axis=0)
    cross = float((before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]).sum())
    angle = float(np.arctan2(cross, float((before * after).sum())))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return RigidMotion(displacement.mean(axis=0), angle, after - before @ turn.T)
