"""Full scale of an image, and the pixels that reach it."""

import numpy as np

from fedic._internal.types import Image

__all__ = ["full_scale", "saturated_share"]

_MIN_SATURATED = 9
"""Number of pixels at the full scale from which on they count as saturated, as in the core."""
_FLOAT_SCALES = (1.0, 255.0, 1023.0, 4095.0, 16383.0, 65535.0)


def full_scale(image: Image) -> float | None:
    """Return the full scale of the grey levels, if more than a few pixels reach it: they may be saturated.

    Parameters
    ----------
    image : ndarray of uint8, uint16 or float32
        The image.

    Returns
    -------
    float or None
        255 of 8 bits; of 16 bits the largest grey level if it is the largest of a number of 8 bits or more, in the low
        or in the high bits; of floating-point numbers the largest if it is 1 or the largest of 8, 10, 12, 14 or 16
        bits. None if fewer than 9 pixels reach it.
    """
    largest = float(image.max())
    if image.dtype == np.uint8:
        is_full = largest == 255.0
    elif image.dtype == np.uint16:
        low, high = int(largest) + 1, (1 << 16) - int(largest)
        is_full = largest >= 255 and (_is_power_of_two(low) or (largest > 1 << 15 and _is_power_of_two(high)))
    else:
        is_full = largest in _FLOAT_SCALES
    return largest if is_full and np.count_nonzero(image == largest) >= _MIN_SATURATED else None


def saturated_share(image: Image) -> float:
    """Return the share of pixels at the full scale.

    Parameters
    ----------
    image : ndarray of uint8, uint16 or float32
        The image.

    Returns
    -------
    float
        From 0 to 1.
    """
    full = full_scale(image)
    return 0.0 if full is None else float(np.mean(image == full))


def _is_power_of_two(number: int) -> bool:
    return number & (number - 1) == 0
