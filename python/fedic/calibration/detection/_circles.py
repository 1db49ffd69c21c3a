"""Centres of circles, without the errors of perspective and lens.

The centroid of the image of a circle is not the image of its centre: the difference is tenths of a pixel for large
circles seen at an angle. Once an approximate camera is known, the pixels around a centre are therefore unprojected to
the plane of the target, and their centroid is computed there, each pixel weighted by its coverage by the circle and by
its area in the plane (cf. Datta, Kim and Kanade, 2009).
"""

import numpy as np

from fedic._internal.types import Floats
from fedic.calibration.target import Target

__all__ = ["centre_in_plane", "centre_reach"]

_REACH = 0.48
_STEPS = 3
_RIM, _CORE = 0.85, 0.3
_HOLLOW = 0.5


def centre_reach(target: Target) -> float:
    """Return the radius of the disc around a centre that is free of other circles."""
    nearest = np.sqrt(2.0) if target.kind == "asymmetric-circles" else 1.0
    return float(min(target.pitches) * _REACH * nearest)


def centre_in_plane(points: Floats, levels: Floats, areas: Floats, start: Floats, reach: float) -> Floats:
    """Return the centre of the circle near a start.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Pixels around the centre, unprojected to the plane of the target.
    levels : ndarray, shape (n,)
        Their grey levels.
    areas : ndarray, shape (n,)
        Their areas in the plane.
    start : ndarray, shape (2,)
        Approximate centre.
    reach : float
        Radius of the disc that is free of other circles.

    Returns
    -------
    ndarray, shape (2,)
        The centre; NaN if there is no circle.
    """
    centre = start
    for _ in range(_STEPS):
        distances = np.linalg.norm(points - centre, axis=1)
        disc, core = distances < reach, distances < _CORE * reach
        rim = disc & (distances > _RIM * reach)
        if not core.any() or not rim.any():
            return np.full(2, np.nan)
        ground = float(np.median(levels[rim]))
        ink = _ink(levels[disc], ground, float(np.median(levels[core])))
        if ink == ground:
            return np.full(2, np.nan)
        cover = np.clip((levels[disc] - ground) / (ink - ground), 0.0, 1.0) * areas[disc]
        centre = cover @ points[disc] / cover.sum()
    return centre


def _ink(levels: Floats, ground: float, core: float) -> float:
    """Return the level of the ink: that of the core, or of the ring around it if the core is of the ground's level."""
    low, high = np.percentile(levels, [5.0, 95.0])
    ring = float(low if ground - low > high - ground else high)
    return core if abs(core - ground) > _HOLLOW * abs(ring - ground) else ring
