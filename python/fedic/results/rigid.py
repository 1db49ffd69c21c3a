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
        Displacement without the rigid motion, in the axes of the deformed configuration; NaN where the displacement is
        not known.
    centre : ndarray, shape (2,)
        Mean of the reference positions of the points.
    """

    translation: Floats
    rotation: float
    residual: Floats
    centre: Floats

    def taken_from(self, points: Floats, displacement: Floats) -> Floats:
        """Return a displacement without the motion: the moved points are shifted and turned back.

        Parameters
        ----------
        points, displacement : ndarray, shape (n, 2)
            Reference positions and displacements.

        Returns
        -------
        ndarray, shape (n, 2)
            ``c + R^T (x - c - t) - X`` with the position ``X``, the moved one ``x``, the centre ``c``, the translation
            ``t`` and the rotation ``R``. Its gradient is ``R^T F - I``: the Green-Lagrange and Hencky strains are those
            of the displacement.
        """
        relative = points - self.centre
        return (relative + displacement - self.translation) @ _turn(self.rotation) - relative


def fit_rigid_motion(points: Floats, displacement: Floats) -> RigidMotion:
    """Fit a translation and a rotation of any size by least squares.

    Parameters
    ----------
    points, displacement : ndarray, shape (n, 2)
        Positions and displacements; points whose displacement is NaN are left out.

    Returns
    -------
    RigidMotion
        The motion that minimises the sum of the squared residuals (the plane case of W. Kabsch, *Acta Cryst.* A32,
        1976); NaN if fewer than two displacements are known.
    """
    known = np.isfinite(displacement).all(axis=1)
    if known.sum() < 2:
        return RigidMotion(np.full(2, np.nan), np.nan, np.full(displacement.shape, np.nan), np.full(2, np.nan))
    centre, translation = points[known].mean(axis=0), displacement[known].mean(axis=0)
    before = points - centre
    after = before + (displacement - translation)
    first, last = before[known], after[known]
    cross = float((first[:, 0] * last[:, 1] - first[:, 1] * last[:, 0]).sum())
    angle = float(np.arctan2(cross, float((first * last).sum())))
    return RigidMotion(translation, angle, after - before @ _turn(angle).T, centre)


def _turn(angle: float) -> Floats:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
