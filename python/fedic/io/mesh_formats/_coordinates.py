"""Coordinate systems in which finite element programs give nodes."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "System", "axes", "from_cylindrical", "from_spherical", "rotated"]

Array = NDArray[np.float64]
System = tuple[Array, Array]
"""Origin, and the three axes as rows."""

_PARALLEL = 1e-10


def axes(first: Array, second: Array) -> Array:
    """Return right-handed unit axes from the direction of the first and a vector in the plane of the first two.

    Parameters
    ----------
    first, second : ndarray, shape (3,)
        The direction of the first axis, and a vector on the positive side of the second.

    Returns
    -------
    ndarray, shape (3, 3)
        The axes as rows.

    Raises
    ------
    ValueError
        If the vectors are zero or parallel.
    """
    third = np.cross(first, second)
    if np.linalg.norm(third) <= _PARALLEL * np.linalg.norm(first) * np.linalg.norm(second):
        raise ValueError("the points of the coordinate system lie on one line")
    x, z = first / np.linalg.norm(first), third / np.linalg.norm(third)
    return np.stack([x, np.cross(z, x), z])


def from_cylindrical(points: Array) -> Array:
    """Return Cartesian coordinates of points given by radius, angle in degrees, and height.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Cylindrical coordinates.

    Returns
    -------
    ndarray, shape (n, 3)
        Cartesian coordinates.
    """
    radius, angle, height = points.T
    cosine, sine = _turn(angle)
    return np.column_stack([radius * cosine, radius * sine, height])


def from_spherical(points: Array) -> Array:
    """Return Cartesian coordinates of points given by radius, angle from z, and angle about z, in degrees.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Spherical coordinates.

    Returns
    -------
    ndarray, shape (n, 3)
        Cartesian coordinates.
    """
    radius, polar, azimuth = points.T
    cosine, sine = _turn(polar)
    return from_cylindrical(np.column_stack([radius * sine, azimuth, radius * cosine]))


def rotated(points: Array, start: Array, end: Array, angle: float) -> Array:
    """Return points turned about an axis.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        The points.
    start, end : ndarray, shape (3,)
        Two points of the axis.
    angle : float
        Degrees, by the right-hand rule about the direction from start to end.

    Returns
    -------
    ndarray, shape (n, 3)
        The turned points.

    Raises
    ------
    ValueError
        If the two points of the axis are one.
    """
    direction = end - start
    length = np.linalg.norm(direction)
    if length == 0.0:
        raise ValueError("the two points of the axis of rotation are the same")
    axis = direction / length
    cosine, sine = _turn(np.array(angle))
    arms = points - start
    along = np.outer(arms @ axis, axis)
    return start + along + cosine * (arms - along) + sine * np.cross(axis, arms)


def _turn(degrees: Array) -> tuple[Array, Array]:
    """Return cosine and sine, exact at quarter turns so that a plane mesh stays plane."""
    quarter = np.round(degrees / 90.0)
    rest = np.deg2rad(degrees - 90.0 * quarter)
    cosine, sine = np.cos(rest), np.sin(rest)
    turn = np.mod(quarter, 4.0)
    return (
        np.choose(turn.astype(np.int64), [cosine, -sine, -cosine, sine]),
        np.choose(turn.astype(np.int64), [sine, cosine, -sine, -cosine]),
    )
