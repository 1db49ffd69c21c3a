"""Arcs and reflections of Abaqus's node generation."""

import numpy as np

from fedic.io.mesh_formats._coordinates import Array

__all__ = ["arc", "reflected"]

_SAME_RADIUS = 1e-3
"""Largest difference of the radii at the two ends of an arc, relative to the larger."""


def arc(ends: Array, centre: Array, normal: Array, shares: Array) -> Array:
    """Return points on an arc between two ends.

    Parameters
    ----------
    ends : ndarray, shape (2, 3)
        The ends.
    centre : ndarray, shape (3,)
        The centre of the circle.
    normal : ndarray, shape (3,)
        The arc turns about it by the right-hand rule; zero for the arc that is shorter than half a turn.
    shares : ndarray, shape (n,)
        Where the points lie: 0 is the first end, 1 the second.

    Returns
    -------
    ndarray, shape (n, 3)
        The points.

    Raises
    ------
    ValueError
        If the ends are not equally far from the centre, or an arc of half a turn has no normal.
    """
    start, end = ends - centre
    radii = np.linalg.norm([start, end], axis=1)
    if abs(radii[1] - radii[0]) > _SAME_RADIUS * radii.max():
        raise ValueError("the two ends are not equally far from the centre of the circle")
    axis = normal if normal.any() else np.cross(start, end)
    if np.linalg.norm(axis) <= 1e-9 * (radii[0] * radii[1] if not normal.any() else 0.0):
        raise ValueError("an arc of half a turn needs its normal")
    axis = axis / np.linalg.norm(axis)
    angle = np.arctan2(np.cross(start, end) @ axis, start @ end) % (2.0 * np.pi)
    angle = angle or 2.0 * np.pi
    radius = radii[0] + shares * (radii[1] - radii[0])
    across = np.cross(axis, start)
    turned = np.outer(np.cos(shares * angle), start) + np.outer(np.sin(shares * angle), across)
    points: Array = centre + turned * (radius / radii[0])[:, np.newaxis]
    return points


def reflected(points: Array, how: str, given: Array) -> Array:
    """Return points reflected through a point, a line by two points or a plane by three.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        The points.
    how : str
        ``"POINT"``, ``"LINE"`` or ``"MIRROR"``.
    given : ndarray, shape (3,), (6,) or (9,)
        Coordinates of the point, of two points or of three.

    Returns
    -------
    ndarray, shape (n, 3)
        The reflected points.

    Raises
    ------
    ValueError
        If the number of coordinates is another, or the points lie together.
    """
    needed = {"POINT": 3, "LINE": 6, "MIRROR": 9}.get(how)
    if needed is None or len(given) != needed:
        raise ValueError(f"REFLECT={how} with {len(given)} coordinates is not known")
    a, *others = given.reshape(-1, 3)
    arms = points - a
    if how == "POINT":
        return np.asarray(a - arms)
    direction = others[0] - a if how == "LINE" else np.cross(others[0] - a, others[1] - a)
    length = np.linalg.norm(direction)
    if length == 0.0:
        raise ValueError("the points of the line or plane lie together")
    along = np.outer(arms @ direction, direction) / length**2
    return np.asarray(a + (2.0 * along - arms if how == "LINE" else arms - 2.0 * along))
