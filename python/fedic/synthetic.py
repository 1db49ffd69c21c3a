"""Synthetic images of a textured plane seen by a camera, at rest or displaced, and known changes of real images."""

import math
from collections.abc import Callable
from typing import Literal, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from fedic._core import Speckle, aperture_points
from fedic._internal.types import Camera, Floats, Image
from fedic.errors import ImageError
from fedic.io.images import as_image
from fedic.progress import ProgressCallback, fraction_callback

__all__ = ["Speckle", "add_noise", "fourier_shift", "render"]

Displacement: TypeAlias = tuple[float, float] | Callable[[Floats], Floats]

_POINTS_PER_CHUNK = 500_000
_DEPTHS = (8, 12, 16)
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
    shot_noise: float = 0.0,
    seed: int = 0,
    progress: ProgressCallback | None = None,
) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Render a textured plane as a camera sees it.

    Each pixel is the mean of the texture over its square aperture, sampled at ``supersampling`` squared points. Its
    centre is brought back to the plane through the camera, lens included (Pierré et al., Sect. 5.2), and the samples
    around it through the inverse Jacobian of the projection there. Their error is of the second order in the size of
    the pixel: 2e-7 px with the lens of ``fedic demo``, 1e-4 px with ``k1 = -0.2`` and a focal length of 1400 px in an
    image as wide.

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
        Grey levels of the texture's 0 and 1, as fractions of the full scale: the contrast is their difference.
    bits : {8, 12, 16}
        Depth of the image; 12 bits are stored in uint16, up to 4095.
    noise, shot_noise : float
        Noise added before rounding, see `add_noise`.
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
    if height < 1 or width < 1 or supersampling < 1 or bits not in _DEPTHS:
        raise ImageError(
            f"render: shape={shape}, supersampling={supersampling}, bits={bits}; the sizes must be at least 1 and bits "
            "one of 8, 12 and 16."
        )
    _check_noise("render", noise, shot_noise)
    rows_per_chunk = max(1, _POINTS_PER_CHUNK // (width * supersampling**2))
    grey = np.empty(shape)
    report = fraction_callback(progress, "render")
    for first in range(0, height, rows_per_chunk):
        last = min(first + rows_per_chunk, height)
        positions = aperture_points(camera, (first, last), width, supersampling, z)
        values = texture.values(_material_points(positions.reshape(-1, 2), displacement))
        grey[first:last] = values.reshape(last - first, width, -1).mean(axis=2)
        report(last / height)
    dark, bright = levels
    grey = (2**bits - 1) * (dark + (bright - dark) * grey)
    return add_noise(grey, noise=noise, shot_noise=shot_noise, seed=seed, bits=bits)


@overload
def add_noise(
    image: Image | Floats, *, noise: float = 0.0, shot_noise: float = 0.0, seed: int = 0, bits: None = None
) -> NDArray[np.float32]: ...
@overload
def add_noise(
    image: Image | Floats, *, noise: float = 0.0, shot_noise: float = 0.0, seed: int = 0, bits: Literal[8, 12, 16]
) -> NDArray[np.uint8] | NDArray[np.uint16]: ...
def add_noise(
    image: Image | Floats,
    *,
    noise: float = 0.0,
    shot_noise: float = 0.0,
    seed: int = 0,
    bits: Literal[8, 12, 16] | None = None,
) -> Image:
    """Add the noise of a sensor to an image.

    A grey level ``g`` receives Gaussian noise of the variance ``noise**2 + shot_noise * g``. The second term is the
    Poisson noise of the photons in its Gaussian approximation, good from about twenty electrons.

    Parameters
    ----------
    image : ndarray of uint8, uint16, float32 or float64, shape (height, width)
        Grey levels.
    noise : float
        Standard deviation of the noise that does not depend on the light, in grey levels.
    shot_noise : float
        Variance per grey level, in grey levels: the inverse of the electrons per grey level. A sensor that saturates at
        10000 electrons and 255 grey levels has 0.0255. Grey levels below zero have none.
    seed : int
        The same seed gives the same noise.
    bits : {8, 12, 16}, optional
        Round to the nearest grey level and clip to the full scale of this depth; neither unless given.

    Returns
    -------
    ndarray, shape (height, width)
        float32, or with `bits` uint8 (8 bits) or uint16 (12 and 16 bits).

    Raises
    ------
    ImageError
        If the image is no image, or an option is out of its range.
    """
    if bits is not None and bits not in _DEPTHS:
        raise ImageError(f"add_noise: bits={bits}; give 8, 12, 16 or None.")
    _check_noise("add_noise", noise, shot_noise)
    grey = _grey_levels(image)
    if noise > 0.0 or shot_noise > 0.0:
        deviation = np.sqrt(noise**2 + shot_noise * np.maximum(grey, 0.0))
        grey = grey + deviation * np.random.default_rng(seed).standard_normal(grey.shape)
    if bits is None:
        return grey.astype(np.float32)
    quantised: Image = np.clip(np.rint(grey), 0, 2**bits - 1).astype(np.uint8 if bits == 8 else np.uint16)
    return quantised


def fourier_shift(image: Image | Floats, shift: tuple[float, float]) -> NDArray[np.float32]:
    """Translate an image by any fraction of a pixel, by the shift theorem.

    What was seen at ``(u, v)`` is seen at ``(u + du, v + dv)``, no frequency weakened. The image is continued by its
    mirror, so that opposite borders that differ do not ring; what enters at a border is that mirror and not what a
    camera would see there.

    Parameters
    ----------
    image : ndarray of uint8, uint16, float32 or float64, shape (height, width)
        Grey levels.
    shift : (du, dv)
        Pixels to the right and downwards.

    Returns
    -------
    ndarray of float32, shape (height, width)
        Grey levels, neither rounded nor clipped; `add_noise` does so.

    Raises
    ------
    ImageError
        If the image is no image, or the shift not a pair of finite numbers.
    """
    distances = np.asarray(shift, dtype=np.float64)
    if distances.shape != (2,) or not np.isfinite(distances).all():
        raise ImageError(f"fourier_shift: shift={shift}; give a pair (du, dv) of finite numbers of pixels.")
    shifted = _grey_levels(image)
    for axis, distance in ((1, distances[0]), (0, distances[1])):
        length = shifted.shape[axis]
        spectrum = np.fft.rfft(np.concatenate([shifted, np.flip(shifted, axis)], axis), axis=axis)
        # The last is the frequency of half a period per pixel, where the mirror leaves nothing: the image stays real.
        phase = np.exp(-1j * np.pi * distance * np.arange(length + 1) / length)
        spectrum *= phase if axis == 1 else phase[:, np.newaxis]
        shifted = np.take(np.fft.irfft(spectrum, 2 * length, axis=axis), range(length), axis=axis)
    return shifted.astype(np.float32)


def _check_noise(caller: str, noise: float, shot_noise: float) -> None:
    if not (0.0 <= noise < math.inf and 0.0 <= shot_noise < math.inf):
        raise ImageError(f"{caller}: noise={noise} and shot_noise={shot_noise}; give finite numbers of at least 0.")


def _grey_levels(image: object) -> Floats:
    as_image(image, "given")
    grey = np.asarray(image, dtype=np.float64)
    if grey.size == 0 or not np.isfinite(grey).all():
        raise ImageError(f"The given image, of shape {grey.shape}, is empty or holds NaN or infinite grey levels.")
    return grey


def _material_points(positions: Floats, displacement: Displacement | None) -> Floats:
    """Return the points ``X`` of the material now at `positions`: ``X + U(X) = positions``."""
    if displacement is None:
        return positions
    if not callable(displacement):
        return positions - np.asarray(displacement, dtype=np.float64)
    tolerance = _INVERSION_TOLERANCE * max(float(np.ptp(positions, axis=0).max()), np.finfo(float).tiny)
    points = positions
    for _ in range(_INVERSION_STEPS):
        moved = np.asarray(displacement(points), dtype=np.float64)
        if moved.shape != points.shape:
            raise ImageError(f"render: the displacement of points {points.shape} has shape {moved.shape}; give (n, 2).")
        previous, points = points, positions - moved
        if float(np.abs(points - previous).max()) <= tolerance:
            return points
    raise ImageError(
        f"render: the displacement could not be inverted in {_INVERSION_STEPS} fixed-point steps; "
        "its gradient must stay well below 1."
    )
