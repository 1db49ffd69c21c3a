"""Synthetic images of a textured plane with known displacement; noise and translation of given images."""

import math
from collections.abc import Callable
from typing import Literal, Protocol, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from fedic._core import Speckle, render_plane
from fedic._internal.types import Camera, Floats, Image
from fedic.errors import ImageError, OptionError
from fedic.io.images import as_image
from fedic.progress import ProgressCallback, fraction_callback

__all__ = ["Speckle", "add_noise", "fourier_shift", "render"]


class Texture(Protocol):
    """A texture of the plane, such as `Speckle`."""

    def values(self, points: Floats, /) -> Floats:
        """Return the values in [0, 1] (n,) at points (n, 2)."""
        ...


Displacement: TypeAlias = tuple[float, float] | Callable[[Floats], Floats]

_DEPTHS = (8, 12, 16)


def render(
    texture: Texture,
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

    Each pixel is the mean of the texture over its square aperture, sampled at ``supersampling`` squared points. The
    centre of the pixel is unprojected to the plane, lens included (Pierré et al., Sect. 5.2), and the samples around
    it through the inverse Jacobian of the projection there. Their error is of the second order in the size of the
    pixel: 2e-7 px with the lens of ``fedic demo``, 1e-4 px with ``k1 = -0.2`` and a focal length of 1400 px in an image
    of that width.

    Parameters
    ----------
    texture : Speckle, or any object with ``values(points)``
        Values in [0, 1] at the points ``(X, Y)`` of the material, in the world's unit.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    shape : (int, int)
        Height and width of the image in pixels.
    displacement : (float, float) or callable, optional
        Displacement ``U`` of the material, in the world's unit: the point ``X`` has moved to ``X + U``. One vector for
        all points, or a function of material points (n, 2) that returns their displacement (n, 2), with a gradient well
        below 1.
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
        Called with a `fedic.Progress` of the stage ``"render"``.

    Returns
    -------
    ndarray of uint8 (8 bits) or uint16 (12 and 16 bits), shape (height, width)
        Rounded to the nearest grey level and clipped to the full scale.

    Raises
    ------
    OptionError
        If an option is out of its range, or the displacement cannot be inverted.
    CameraError
        If a pixel sees no point of the plane.
    """
    for option, value in (("shape", min(shape)), ("supersampling", supersampling)):
        if value < 1:
            raise OptionError(f"render: {option}={value}; it must be at least 1.", option)
    if bits not in _DEPTHS:
        raise OptionError(f"render: bits={bits}; give 8, 12 or 16.", "bits")
    _check_noise("render", noise, shot_noise)
    report = fraction_callback(progress, "render")
    grey = render_plane(texture, camera, shape, _as_function(displacement), z, supersampling, report)
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
        Seed of the noise.
    bits : {8, 12, 16}, optional
        Round to the nearest grey level and clip to the full scale of this depth; neither unless given.

    Returns
    -------
    ndarray, shape (height, width)
        float32, or with `bits` uint8 (8 bits) or uint16 (12 and 16 bits).

    Raises
    ------
    ImageError
        If the image cannot be used.
    OptionError
        If an option is out of its range.
    """
    if bits is not None and bits not in _DEPTHS:
        raise OptionError(f"add_noise: bits={bits}; give 8, 12, 16 or None.", "bits")
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

    The point at ``(u, v)`` moves to ``(u + du, v + dv)``, and no frequency is attenuated. The image is continued by
    reflection, so that opposite borders of different grey levels cause no ringing; a reflection enters at the borders,
    not the image that a camera would see there.

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
        If the image cannot be used.
    OptionError
        If the shift is not a pair of finite numbers.
    """
    distances = np.asarray(shift, dtype=np.float64)
    if distances.shape != (2,) or not np.isfinite(distances).all():
        raise OptionError(f"fourier_shift: shift={shift}; give a pair (du, dv) of finite numbers of pixels.", "shift")
    shifted = _grey_levels(image)
    for axis, distance in ((1, distances[0]), (0, distances[1])):
        length = shifted.shape[axis]
        spectrum = np.fft.rfft(np.concatenate([shifted, np.flip(shifted, axis)], axis), axis=axis)
        # At half a period per pixel, the last frequency, a reflected image has no content: the result stays real.
        phase = np.exp(-1j * np.pi * distance * np.arange(length + 1) / length)
        spectrum *= phase if axis == 1 else phase[:, np.newaxis]
        shifted = np.take(np.fft.irfft(spectrum, 2 * length, axis=axis), range(length), axis=axis)
    return shifted.astype(np.float32)


def _check_noise(caller: str, noise: float, shot_noise: float) -> None:
    for option, value in (("noise", noise), ("shot_noise", shot_noise)):
        if not 0.0 <= value < math.inf:
            raise OptionError(f"{caller}: {option}={value}; give a finite number of at least 0.", option)


def _grey_levels(image: object) -> Floats:
    as_image(image, "given")
    grey = np.asarray(image, dtype=np.float64)
    if grey.size == 0 or not np.isfinite(grey).all():
        raise ImageError(f"The given image, of shape {grey.shape}, is empty or holds NaN or infinite grey levels.")
    return grey


def _as_function(displacement: Displacement | None) -> Callable[[Floats], Floats] | None:
    if displacement is None or callable(displacement):
        return displacement
    vector = np.asarray(displacement, dtype=np.float64)
    if vector.shape != (2,):
        message = f"render: displacement={displacement}; give a pair of numbers, or a function."
        raise OptionError(message, "displacement")
    return lambda points: np.broadcast_to(vector, points.shape)
