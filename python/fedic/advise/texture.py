"""Texture of an image: speckle size, contrast, gradient, saturation."""

from dataclasses import dataclass

import numpy as np

from fedic._internal.saturation import saturated_share
from fedic._internal.types import Floats, Image

__all__ = ["Texture", "speckle_size", "texture_of"]

_SIDE = 512
"""Largest side of the window of the autocorrelation, in pixels."""


@dataclass(frozen=True)
class Texture:
    """Statistics of the grey levels of a region.

    Attributes
    ----------
    speckle_size : (float, float)
        Full width at half maximum of the autocorrelation along u and v, in pixels; NaN without texture.
    contrast : float
        Standard deviation of the grey levels without that of the noise.
    grey_range : (float, float)
        Grey levels that 1 % of the pixels lie below and above.
    gradient : (float, float)
        Root mean square of the central differences along u and v without that of the noise, in grey levels per pixel.
    saturated_share : float
        Share of saturated pixels.
    """

    speckle_size: tuple[float, float]
    contrast: float
    grey_range: tuple[float, float]
    gradient: tuple[float, float]
    saturated_share: float


def texture_of(image: Image, noise: float) -> Texture:
    """Describe the texture of an image.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image, or a region of it.
    noise : float
        Standard deviation of the noise, in grey levels.

    Returns
    -------
    Texture
        The statistics.
    """
    grey = image.astype(np.float64)
    differences = (0.5 * (grey[:, 2:] - grey[:, :-2]), 0.5 * (grey[2:] - grey[:-2]))
    along_u, along_v = (float(np.sqrt(max(0.0, (each**2).mean() - 0.5 * noise**2))) for each in differences)
    low, high = np.percentile(grey, [1.0, 99.0])
    return Texture(
        speckle_size=speckle_size(grey, noise),
        contrast=float(np.sqrt(max(0.0, grey.var() - noise**2))),
        grey_range=(float(low), float(high)),
        gradient=(along_u, along_v),
        saturated_share=saturated_share(image),
    )


def speckle_size(grey: Floats, noise: float) -> tuple[float, float]:
    """Measure the width of the autocorrelation.

    Parameters
    ----------
    grey : ndarray, shape (height, width)
        Grey levels; of a large image the middle is used.
    noise : float
        Standard deviation of white noise, in grey levels, which adds to the autocorrelation at zero alone.

    Returns
    -------
    (float, float)
        Full width at half maximum along u and v, in pixels, the plane of the light removed; NaN if the noise is all
        there is, or the width exceeds half the window.
    """
    height, width = grey.shape
    top, left = max(0, (height - _SIDE) // 2), max(0, (width - _SIDE) // 2)
    window = grey[top : top + _SIDE, left : left + _SIDE]
    window = window - _plane(window)
    peak = float(window.var()) - noise**2
    # The scatter of a variance of n normal numbers is sqrt(2 / n); below a tenth the texture measures nothing.
    if peak <= noise**2 * max(0.1, 6.0 * np.sqrt(2.0 / window.size)):
        return np.nan, np.nan
    return _width(window, peak), _width(window.T, peak)


def _plane(window: Floats) -> Floats:
    v, u = (np.linspace(-1.0, 1.0, length) for length in window.shape)
    along_u = u * (window.mean(axis=0) @ u) / (u @ u)
    along_v = v * (window.mean(axis=1) @ v) / (v @ v)
    return np.asarray(window.mean() + along_u + along_v[:, np.newaxis])


def _width(window: Floats, peak: float) -> float:
    """Return the full width at half maximum of the autocorrelation along the rows."""
    before = 1.0
    for lag in range(1, window.shape[1] // 4 + 1):
        value = float((window[:, lag:] * window[:, :-lag]).mean()) / peak
        if value < 0.5:
            return 2.0 * (lag - 1 + (before - 0.5) / (before - value))
        before = value
    return np.nan
