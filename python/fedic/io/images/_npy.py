"""NumPy's ``.npy``."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._faults import damaged
from fedic.io.images._levels import luminance

__all__ = ["read_npy"]

_COLOURS = (3, 4)


def read_npy(path: Path, page: int | None, mapped: bool) -> Image:
    """Read an array of grey levels or colours; objects, which would need pickle, are refused.

    Parameters
    ----------
    path : Path
        The file. It holds an array of shape (height, width), (height, width, 3 or 4), or several images along a first
        axis more.
    page : int or None
        Which of several images.
    mapped : bool
        Not used: the array is always copied.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        Its grey levels.

    Raises
    ------
    ImageError
        If the file is cut, holds several images and none is named, or no image.
    """
    array = _open(path)
    colours = array.ndim in (3, 4) and array.shape[-1] in _COLOURS
    if array.ndim - colours == 3:
        count = len(array)
        if page is None:
            raise ImageError(
                f"the array has shape {array.shape} and holds {count} images; name one by its number, from 0: "
                f"{path.name}#0 to {path.name}#{count - 1}."
            )
        if page >= count:
            raise ImageError(f"page {page} does not exist: the array holds {count} images, 0 to {count - 1}.")
        array = array[page]
    elif array.ndim - colours != 2:
        raise ImageError(
            f"the array has shape {array.shape}; save an image of shape (height, width) or (height, width, 3)."
        )
    elif page:
        raise ImageError(f"page {page} does not exist: the file holds one image.")
    return luminance(np.array(array))


def _open(path: Path) -> NDArray[Any]:
    try:
        array = np.lib.format.open_memmap(path, mode="r")
    except ValueError as error:
        if "object" in str(error).lower():
            raise ImageError("the array holds Python objects; save numbers, with numpy.save.") from error
        raise damaged("it is not an array that numpy.save has written") from error
    if array.dtype.kind not in "biuf":
        raise ImageError(f"the array holds {array.dtype} values; save 8 bit, 16 bit or 32-bit float.")
    if array.offset + array.nbytes != path.stat().st_size:
        raise damaged("it holds more data than its header states")
    return array
