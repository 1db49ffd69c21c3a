"""Grey levels from the samples that a file stores."""

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Image
from fedic.errors import ImageError

__all__ = ["luminance"]

_EXACT_FLOAT = 1 << 24
"""Integers up to this one are exact in single precision."""


def _as_levels(samples: NDArray[Any]) -> NDArray[Any]:
    """Convert samples to a type of grey levels.

    Parameters
    ----------
    samples : ndarray, any shape
        The samples as stored.

    Returns
    -------
    ndarray of uint8, uint16 or float32, same shape
        uint8, uint16 and float32 as they are; bool as 0 and 1; half and double precision in single precision; other
        integers as uint16 if all fit, else as float32 if all are exact.

    Raises
    ------
    ImageError
        If the samples are of another type, or too large.
    """
    dtype = np.dtype(samples.dtype.type)
    if dtype.type in (np.uint8, np.uint16, np.float32):
        return np.asarray(samples, dtype=dtype)
    if dtype.kind == "b":
        return samples.astype(np.uint8)
    if dtype.kind == "f":
        with np.errstate(over="ignore"):
            levels = samples.astype(np.float32)
        if np.isinf(levels).any() and not np.isinf(samples).any():
            raise ImageError("the image holds values beyond 3.4e38; scale them and save them as 32-bit float.")
        return levels
    if dtype.kind not in "iu":
        raise ImageError(f"the image holds {dtype} values; save it in 8 bit, 16 bit or 32-bit float.")
    lowest, highest = (int(samples.min()), int(samples.max())) if samples.size else (0, 0)
    if lowest >= 0 and highest <= np.iinfo(np.uint16).max:
        return samples.astype(np.uint16)
    if max(-lowest, highest) <= _EXACT_FLOAT:
        return samples.astype(np.float32)
    raise ImageError(
        f"the image holds {dtype} values from {lowest} to {highest}, which 32-bit float cannot hold exactly; scale "
        "them and save them in 16 bit or 32-bit float."
    )


def luminance(samples: NDArray[Any]) -> Image:
    """Reduce grey levels or colours to grey levels.

    Parameters
    ----------
    samples : ndarray, shape (height, width) or (height, width, n)
        Grey levels, also with alpha (`n` is 1 or 2); or red, green and blue, also with alpha (`n` is 3 or 4).

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        The luminance (Rec. 601); alpha is left out.

    Raises
    ------
    ImageError
        If the samples have another shape, or a type that is not read.
    """
    if samples.ndim == 3 and 1 <= samples.shape[2] <= 4:
        samples = samples[:, :, 0] if samples.shape[2] < 3 else samples[:, :, :3]
    elif samples.ndim != 2:
        raise ImageError(f"the image has shape {samples.shape}; save it as grey or RGB.")
    levels = np.ascontiguousarray(_as_levels(samples))
    if levels.ndim == 3:
        import cv2

        levels = np.asarray(cv2.cvtColor(levels, cv2.COLOR_RGB2GRAY), dtype=levels.dtype)
    return cast(Image, levels)
