"""Noise, light and motion of two images."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.noise._gradient import NOISE_GAIN
from fedic.noise._tiles import TileFit, fit_tiles, inner
from fedic.noise._translation import whole_pixel_shift

__all__ = ["LARGEST_MOTION", "PairNoise", "noise_of_pair"]

LARGEST_MOTION = 0.2
"""Motion in pixels up to which the noise is corrected: beyond it the gradient does not explain the difference."""
_SIGNIFICANCE = 6.0
_LEAST_EXCESS = 0.01
"""Excess of the reading from which on the images count as moved."""
_LARGEST_CORRELATION = 0.1
"""Correlation of neighbours in what is left of a moved pair from which on it is not noise alone."""
_CHANGED = 0.7
"""Correlation of neighbours from which on it is not noise at all: compression and colour filters stay below."""


@dataclass(frozen=True)
class PairNoise:
    """What two images tell.

    Attributes
    ----------
    raw_variance : float
        Half the variance of the difference without a gain and an offset of the whole image.
    variance : float
        Variance of the noise of one image; NaN if the pair is refused.
    map : ndarray
        Variance of each pixel, half the squared residual; NaN at pixels that were not used. All are NaN if the pair is
        refused.
    shift, shift_error : ndarray, shape (2,)
        Translation ``(u, v)`` from the first to the second image and its standard error, in pixels; NaN without
        texture. Of a motion of more than half a pixel, its whole pixels.
    motion : float
        Root mean square of the motion over the image, in pixels, also of a rotation.
    excess : float
        How much too high the standard deviation reads because of the motion, relative to that without.
    moved, refused : bool
        Whether the motion matters, and whether it is too large to be corrected.
    products : ndarray, shape (3,)
        Mean squares of the residual, and mean products of neighbours along u and v.
    """

    raw_variance: float
    variance: float
    map: Floats
    shift: Floats
    shift_error: Floats
    motion: float
    excess: float
    moved: bool
    refused: bool
    products: Floats


def noise_of_pair(first: Floats, second: Floats, used: NDArray[np.bool_]) -> PairNoise:
    """Separate noise, light and motion.

    Parameters
    ----------
    first, second : ndarray, shape (height, width)
        Grey levels.
    used : ndarray of bool, shape (height, width)
        Pixels to use.

    Returns
    -------
    PairNoise
        The outcome.
    """
    raw = _raw_variance(first, second, used)
    fit = fit_tiles(first, second, used)
    products = _products(fit.residual)
    shift, error, motion, attenuation = _motion(fit)
    whole = np.array(whole_pixel_shift(first, second), dtype=np.float64)
    far = bool(whole.any())
    ratio = fit.motion_variance / fit.variance if fit.variance > 0.0 else 0.0
    excess = float(np.sqrt(1.0 + max(0.0, ratio)) - 1.0)
    correlation = np.abs(products[1:]).max() / max(products[0], np.finfo(float).tiny)
    changed = correlation > _CHANGED
    moved = far or changed or (fit.motion_score > _SIGNIFICANCE and excess > _LEAST_EXCESS)
    refused = far or changed or (moved and (not motion <= LARGEST_MOTION or correlation > _LARGEST_CORRELATION))
    # The noise of the gradient, multiplied by the motion, is in the residual too.
    spread = 1.0 + (motion**2 * NOISE_GAIN * attenuation / 4.0 if moved and not refused else 0.0)
    if far:
        shift, error, motion = whole, np.full(2, 0.5), float(np.hypot(*whole))
    if refused:
        excess = np.nan
    variance = np.nan if refused else 0.5 * fit.variance / spread
    per_pixel = np.full(fit.residual.shape, np.nan) if refused else 0.5 * fit.residual**2 / fit.freedom / spread
    return PairNoise(raw, variance, per_pixel, shift, error, motion, excess, moved, refused, products)


def _raw_variance(first: Floats, second: Floats, used: NDArray[np.bool_]) -> float:
    mean, difference = (inner(values)[inner(used)] for values in (0.5 * (first + second), second - first))
    mean -= mean.mean()
    difference -= difference.mean()
    left = difference - mean * (mean @ difference) / max(float(mean @ mean), float(np.finfo(float).tiny))
    return float(0.5 * (left @ left) / (len(left) - 2))


def _motion(fit: TileFit) -> tuple[Floats, Floats, float, float]:
    """Return the translation, its standard error, the rms motion and the share of the gradient that is not noise.

    The noise adds to the mean square of the gradient, so that the translation comes out too small by that share; what
    it adds is known and subtracted.
    """
    unknown = np.full(2, np.nan)
    texture = fit.energy - 0.25 * NOISE_GAIN * fit.variance * fit.pixels * np.eye(2)
    values = np.linalg.eigvalsh(texture)
    if fit.pixels == 0 or values[0] <= 0.05 * np.trace(fit.energy):
        return unknown, unknown, np.nan, 1.0
    shift = np.asarray(-np.linalg.solve(texture, fit.moment), dtype=np.float64)
    inverse = np.linalg.inv(texture)
    error: Floats = np.sqrt(np.diag(fit.variance * inverse @ fit.energy @ inverse))
    share = float(np.trace(texture) / np.trace(fit.energy))
    squares = max(0.0, fit.motion_variance * fit.pixels)
    motion = float(np.sqrt(squares / (0.5 * np.trace(fit.energy))) / share)
    return shift, error, motion, share


def _products(residual: Floats) -> Floats:
    pairs = ((residual, residual), (residual[:, 1:], residual[:, :-1]), (residual[1:], residual[:-1]))
    with np.errstate(invalid="ignore"):
        means = [np.nanmean(a * b) if np.isfinite(a * b).any() else np.nan for a, b in pairs]
    return np.array(means)
