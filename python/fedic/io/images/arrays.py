"""Checks of images given as arrays."""

import mmap
from typing import cast

import numpy as np

from fedic._internal.types import Image
from fedic.errors import ImageError

__all__ = ["as_image", "copy_if_writable", "release_pages", "validate_deformed"]


def as_image(image: object, name: str) -> Image:
    """Check an array of grey levels.

    Parameters
    ----------
    image : object
        Image given by the caller.
    name : str
        Name in messages, such as ``"reference"``.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        The array, made contiguous; float64 becomes float32.

    Raises
    ------
    ImageError
        If it is not a 2-D array of one of these types, or has masked pixels.
    """
    if not isinstance(image, np.ndarray):
        raise ImageError(
            f"The {name} image is a {type(image).__name__}; give a NumPy array (fedic.read_image reads files)."
        )
    if np.ma.is_masked(image):
        raise ImageError(
            f"The {name} image is a masked array, whose mask is not used here; give its data, and leave out pixels of "
            "the reference image by the option mask of fedic.correlate."
        )
    if image.ndim != 2:
        raise ImageError(
            f"The {name} image has shape {image.shape}; give a grey image of shape (height, width) "
            "(fedic.read_image reduces colour to luminance)."
        )
    if image.dtype.type not in (np.uint8, np.uint16, np.float32, np.float64):
        raise ImageError(f"The {name} image holds {image.dtype} values; convert it to uint8, uint16 or float32.")
    kept = np.float32 if image.dtype.type is np.float64 else image.dtype.type
    return cast(Image, np.ascontiguousarray(image, dtype=kept))


def copy_if_writable(image: object, name: str) -> Image:
    """Check an array of grey levels that is kept, and copy it if the caller could still write to it.

    Parameters
    ----------
    image : object
        Image given by the caller.
    name : str
        Name in messages, such as ``"reference"``.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        As from `as_image`; it shares memory with `image` only if that memory is read-only.

    Raises
    ------
    ImageError
        If it is not a 2-D array of one of these types.
    """
    checked = as_image(image, name)
    base: object = checked
    writeable = False
    while isinstance(base, np.ndarray):
        writeable |= base.flags.writeable
        base = base.base
    fixed = not writeable and (base is None or isinstance(base, (bytes, mmap.mmap)))
    return checked if fixed or not np.may_share_memory(checked, cast(Image, image)) else checked.copy()


def validate_deformed(reference: Image, deformed: object) -> Image:
    """Check a deformed image against the reference image.

    Parameters
    ----------
    reference : ndarray, shape (height, width)
        The reference image.
    deformed : object
        Deformed image given by the caller.

    Returns
    -------
    ndarray, shape (height, width)
        The deformed image, as from `as_image`.

    Raises
    ------
    ImageError
        If it is not an image, or not of the size of the reference.
    """
    checked = as_image(deformed, "deformed")
    if checked.shape != reference.shape:
        raise ImageError(
            f"The deformed image is {_size(checked)} and the reference image is {_size(reference)}; "
            "both must come from the same sensor area."
        )
    return checked


def release_pages(image: Image) -> None:
    """Return the memory of an image that is mapped from its file to the system, until it is read again.

    Parameters
    ----------
    image : ndarray
        Any image; does nothing unless it is a read-only memory map.
    """
    base: object = image
    read_only = False
    while isinstance(base, np.ndarray):
        read_only |= isinstance(base, np.memmap) and base.mode == "r"
        base = base.base
    if read_only and isinstance(base, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED"):
        base.madvise(mmap.MADV_DONTNEED)


def _size(image: Image) -> str:
    height, width = image.shape
    return f"{width} x {height} px (width x height)"
