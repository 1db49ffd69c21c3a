"""Masks of pixels given as an image or as polygons."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic.errors import OptionError

__all__ = ["pixel_mask"]

_FRACTION_BITS = 6


def pixel_mask(mask: object, shape: tuple[int, int]) -> NDArray[np.bool_] | None:
    """Return the pixels that are left out.

    Parameters
    ----------
    mask : array_like, shape (height, width), or sequence of polygons, or None
        True or not zero where a pixel is left out; or polygons around what is left out, each of shape (k, 2), their
        corners ``(u, v)`` in pixels.
    shape : (int, int)
        Height and width of the image.

    Returns
    -------
    ndarray of bool, shape (height, width), or None
        The mask; None if nothing is left out.

    Raises
    ------
    OptionError
        If it is neither.
    """
    if mask is None:
        return None
    image = _as_array(mask)
    if image is not None and image.shape == shape and image.dtype.kind in "biuf":
        masked = np.ascontiguousarray(image != 0)
    elif isinstance(mask, np.ndarray) and mask.ndim == 2 and mask.shape[1] != 2:
        raise OptionError(f"mask has shape {mask.shape}; the reference image has shape {shape}", "mask")
    else:
        masked = _filled(mask, shape)
    return masked if masked.any() else None


def _as_array(mask: object) -> NDArray[Any] | None:
    try:
        return np.asarray(mask)
    except ValueError:
        return None


def _filled(mask: object, shape: tuple[int, int]) -> NDArray[np.bool_]:
    import cv2

    polygons = [mask] if isinstance(mask, np.ndarray) and mask.ndim == 2 else mask
    if not isinstance(polygons, (list, tuple, np.ndarray)):
        raise OptionError(f"mask must be an image of shape {shape} or a list of polygons, got {mask!r:.80}", "mask")
    filled = np.zeros(shape, dtype=np.uint8)
    limit = 4.0 * max(shape)
    for index, polygon in enumerate(polygons):
        try:
            corners = np.array(polygon, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise OptionError(f"polygon {index} of the mask is not an array of numbers ({error})", "mask") from error
        if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3 or not np.isfinite(corners).all():
            raise OptionError(
                f"polygon {index} of the mask has shape {corners.shape}; give at least three finite corners (u, v)",
                "mask",
            )
        fixed = np.rint(np.clip(corners, -limit, limit) * 2**_FRACTION_BITS).astype(np.int32)
        cv2.fillPoly(filled, [fixed], (1,), shift=_FRACTION_BITS)
    return np.asarray(filled != 0)
