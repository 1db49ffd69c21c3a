"""The mean of several images of one state."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images.arrays import as_image
from fedic.io.images.reader import read_image

__all__ = ["mean_image"]


def mean_image(parts: Sequence[str | Path | NDArray[Any]], name: str) -> Image:
    """Return the mean of images, as float32; a single one as it is.

    Parameters
    ----------
    parts : sequence of path or ndarray of shape (height, width)
        The images, one or more; files are mapped as by ``read_image(path, mapped=True)``.
    name : str
        Name in messages, such as ``"reference"``.

    Returns
    -------
    ndarray, shape (height, width)
        The image.

    Raises
    ------
    ImageError
        If one cannot be read, or they differ in size.
    """
    if len(parts) == 1:
        return _image(parts[0], name)
    total: NDArray[np.float64] | None = None
    for part in parts:
        image = _image(part, name)
        if total is None:
            total = np.zeros(image.shape)
        if image.shape != total.shape:
            where = part if isinstance(part, (str, Path)) else "an array"
            raise ImageError(
                f"{name}: the images of a mean must have one size; {where} has shape {image.shape}, the first "
                f"{total.shape}."
            )
        total += image
    if total is None:
        raise ImageError(f"{name}: there is no image to take the mean of.")
    return (total / len(parts)).astype(np.float32)


def _image(part: str | Path | NDArray[Any], name: str) -> Image:
    return read_image(part, mapped=True) if isinstance(part, (str, Path)) else as_image(part, name)
