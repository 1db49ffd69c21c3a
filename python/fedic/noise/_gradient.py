"""Gradient of an image by central differences of sixth order."""

import numpy as np

from fedic._internal.types import Floats

__all__ = ["MARGIN", "NOISE_GAIN", "gradient"]

_WEIGHTS = (45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0)
MARGIN = len(_WEIGHTS)
"""Pixels along each border without a gradient."""
NOISE_GAIN = 2.0 * sum(weight**2 for weight in _WEIGHTS)
"""Variance of a derivative of white noise of variance 1."""


def gradient(image: Floats) -> tuple[Floats, Floats]:
    """Return the derivatives along u and v.

    The error at a wave of 8 px is 0.2 %, where central differences of second order are 10 % too small.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        Grey levels.

    Returns
    -------
    (ndarray, ndarray), shape (height - 2 MARGIN, width - 2 MARGIN)
        In grey levels per pixel, without the borders.
    """
    height, width = image.shape
    inner = slice(MARGIN, -MARGIN)
    along_u = np.zeros((height - 2 * MARGIN, width - 2 * MARGIN))
    along_v = np.zeros_like(along_u)
    for step, weight in enumerate(_WEIGHTS, start=1):
        ahead, behind = (slice(MARGIN + sign * step, length) for sign, length in ((1, None), (-1, None)))
        along_u += weight * (image[inner, ahead][:, : along_u.shape[1]] - image[inner, behind][:, : along_u.shape[1]])
        along_v += weight * (image[ahead, inner][: along_v.shape[0]] - image[behind, inner][: along_v.shape[0]])
    return along_u, along_v
