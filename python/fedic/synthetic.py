"""Synthetic images of a textured plane seen by a camera, at rest or displaced: the ground truth of tests."""

from collections.abc import Callable
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._core import Speckle, aperture_points
from fedic._types import Camera, Floats
from fedic.errors import ImageError

__all__ = ["Speckle", "render"]

Displacement: TypeAlias = tuple[float, float] | Callable[[Floats], Floats]

_POINTS_PER_CHUNK = 500_000
_INVERSION_STEPS = 60
_INVERSION_TOLERANCE = 1e-10


def render(
    texture: Speckle,
    camera: Camera,
    shape: tuple[int, int],
    *,
    displacement: Displacement | None = None,
    z: float = 0.0,
    supersampling: int = 3,
    levels: tuple[float, float] = (0.1, 0.9),
    bits: Literal[8, 12, 16] = 8,
    noise: float = 0.0,
    seed: int = 0,
    progress: Callable[[float], object] | None = None,
) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Render a textured plane as a camera sees it.

    Each pixel is the mean of the texture over its square aperture, sampled at ``supersampling`` squared points that are
    brought back to the plane through the camera, lens included.

    Parameters
    ----------
    texture : Speckle
        Values in [0, 1] at the points ``(X, Y)`` of the material, in the world's unit.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    shape : (int, int)
        Height and width of the image in pixels.
    displacement : (float, float) or callable, optional
        How the material moved, in the world's unit: the point ``X`` is now at ``X + U``. One vector for all, or a
        function that takes material points (n, 2) and returns their displacement (n, 2), of gradient below 1.
    z : float
        Height of the plane in the world.
    supersampling : int
        Samples per pixel in each direction.
    levels : (float, float)
        Grey levels of the texture's 0 and 1, as fractions of the full scale.
    bits : {8, 12, 16}
        Depth of the image; 12 bits are stored in uint16, up to 4095.
    noise : float
        Standard deviation, in grey levels, of the Gaussian noise added before rounding.
    seed : int
        Seed of the noise.
    progress : callable, optional
        Called with the fraction done.

    Returns
    -------
    ndarray of uint8 (8 bits) or uint16 (12 and 16 bits), shape (height, width)
        Rounded to the nearest grey level and clipped to the full scale.

    Raises
    ------
    ImageError
        If an option is out of its range, or the displacement cannot be inverted.
    CameraError
        If some pixel sees no point of the plane.
    """
    height, width = shape
    if height < 1 or width < 1 or supersampling < 1 or bits not in (8, 12, 16) or noise < 0.0:
        raise ImageError(
            f"render: shape={shape}, supersampling={supersampling}, bits={bits}, noise={noise}; the sizes must be at "
            "least 1, bits one of 8, 12 and 16, and noise at least 0."
        )
    full_scale = 2**bits - 1
    dark, bright = levels
    rows_per_chunk = max(1, _POINTS_PER_CHUNK // (width * supersampling**2))
    grey = np.empty(shape)
    for first in range(0, height, rows_per_chunk):
        last = min(first + rows_per_chunk, height)
        positions = aperture_points(camera, (first, last), width, supersampling, z)
        values = texture.values(_material_points(positions.reshape(-1, 2), displacement))
        grey[first:last] = values.reshape(last - first, width, -1).mean(axis=2)
        if progress is not None:
            progress(last / height)
    grey = full_scale * (dark + (bright - dark) * grey)
    if noise > 0.0:
        grey += np.random.default_rng(seed).normal(0.0, noise, shape)
    image: NDArray[np.uint8] | NDArray[np.uint16]
    image = np.clip(np.rint(grey), 0, full_scale).astype(np.uint8 if bits == 8 else np.uint16)
    return image


def _material_points(positions: Floats, displacement: Displacement | None) -> Floats:
    """Return the points ``X`` of the material now at `positions`: ``X + U(X) = positions``."""
    if displacement is None:
        return positions
    if not callable(displacement):
        return positions - np.asarray(displacement, dtype=np.float64)
    tolerance = _INVERSION_TOLERANCE * max(float(np.ptp(positions, axis=0).max()), np.finfo(float).tiny)
    points = positions
    for _ in range(_INVERSION_STEPS):
        previous, points = points, positions - np.asarray(displacement(points), dtype=np.float64)
        if float(np.abs(points - previous).max()) <= tolerance:
            return points
    raise ImageError(
        f"render: the displacement could not be inverted in {_INVERSION_STEPS} fixed-point steps; "
        "its gradient must stay well below 1."
    )
