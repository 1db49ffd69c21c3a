"""Displacement of points in the image."""

import numpy as np

from fedic._internal.types import Camera, Floats

__all__ = ["pixel_displacement"]


def pixel_displacement(camera: Camera, points: Floats, displacement: Floats) -> Floats:
    """Return the displacement of points in the image.

    Parameters
    ----------
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    points : ndarray, shape (n, 2) or (n, 3)
        Reference positions, in the mesh's unit.
    displacement : ndarray, shape (n, 2)
        Displacements along x and y, in the mesh's unit.

    Returns
    -------
    ndarray, shape (n, 2)
        ``(u, v)`` in pixels; NaN where the displacement is NaN.
    """
    moved = points.copy()
    moved[:, :2] += displacement
    pixels = np.full(displacement.shape, np.nan)
    known = np.isfinite(displacement).all(axis=1)
    pixels[known] = camera.project(moved[known]) - camera.project(points[known])
    return pixels
