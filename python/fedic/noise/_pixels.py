"""Checks of the images, and the pixels whose noise is not cut off by the end of the grey levels."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fedic._core import full_scale
from fedic._internal.types import Floats, Image, StrPath
from fedic.errors import ImageError, OptionError
from fedic.io.images import as_image, read_image

__all__ = ["checked_images", "cut_off", "grey_step"]

_SMALLEST = 32
_MARGIN = 4.0
"""Standard deviations of the noise between a pixel and the end of the grey levels."""


def checked_images(images: Sequence[Image | StrPath]) -> list[Image]:
    """Read and check images.

    Parameters
    ----------
    images : sequence of ndarray, str or path
        The images, or their files.

    Returns
    -------
    list of ndarray, shape (height, width)
        The images.

    Raises
    ------
    OptionError
        If there are fewer than two.
    ImageError
        If one cannot be used, is constant, differs in size or type, or equals the one before.
    """
    if isinstance(images, (str, bytes, np.ndarray)) and not (isinstance(images, np.ndarray) and images.ndim == 3):
        raise OptionError("images is one image; give a list of two or more static ones.", "images")
    if len(images) < 2:
        raise OptionError(
            f"{len(images)} image was given; the noise needs two or more of the same scene at rest.", "images"
        )
    read = [as_image(each, _name(each, k)) if _is_array(each) else read_image(each) for k, each in enumerate(images)]  # type: ignore[arg-type]
    for number, (image, given) in enumerate(zip(read, images, strict=True)):
        name = _name(given, number)
        if image.shape != read[0].shape or image.dtype != read[0].dtype:
            raise ImageError(
                f"The {name} image is {_size(image)} and the {_name(images[0], 0)} image {_size(read[0])}; "
                "give images of one camera with the same settings."
            )
        if min(image.shape) < _SMALLEST:
            raise ImageError(f"The {name} image is {_size(image)}; at least {_SMALLEST} px along each side are needed.")
        if not np.isfinite(image).all():
            raise ImageError(f"The {name} image holds NaN or infinite grey levels.")
        if image.min() == image.max():
            raise ImageError(
                f"The {name} image is constant: it shows no noise. Was the lens covered, or all saturated?"
            )
        if number and np.array_equal(image, read[number - 1]):
            raise ImageError(
                f"The {name} image equals the one before pixel by pixel: a copy tells nothing about the noise."
            )
    return read


def cut_off(images: Sequence[Image], mean: Floats) -> NDArray[np.bool_]:
    """Return the pixels at or near the end of the grey levels, where the noise is cut off.

    Parameters
    ----------
    images : sequence of ndarray, shape (height, width)
        The images.
    mean : ndarray, shape (height, width)
        Their mean, which does not tell the sign of the noise of any of them.

    Returns
    -------
    ndarray of bool, shape (height, width)
        True where the mean is within four standard deviations of the noise from a full scale that is reached, or from
        black if that is reached.
    """
    difference = images[1].astype(np.float64) - images[0]
    spread = 1.4826 * float(np.median(np.abs(difference - np.median(difference)))) / np.sqrt(2.0)
    margin = _MARGIN * max(spread, 0.25 * grey_step(images[0]))
    left_out = np.zeros(mean.shape, dtype=bool)
    scales = [scale for image in images if (scale := full_scale(image)) is not None]
    if scales:
        left_out |= mean >= max(scales) - margin
    if images[0].dtype.kind == "u" and any(np.count_nonzero(image == 0) > 0 for image in images):
        left_out |= mean <= margin
    return left_out


def grey_step(image: Image) -> float:
    """Return the distance of neighbouring grey levels.

    Parameters
    ----------
    image : ndarray
        The image.

    Returns
    -------
    float
        The largest power of two that divides all grey levels: 16 for 12 bits stored in the high bits of 16; 0 for
        floating-point images.
    """
    if image.dtype.kind != "u":
        return 0.0
    bits = int(np.bitwise_or.reduce(image, axis=None))
    return float(bits & -bits)


def _is_array(image: object) -> bool:
    return not isinstance(image, str) and not hasattr(image, "__fspath__")


def _name(image: object, number: int) -> str:
    return f"{number + 1}." if _is_array(image) else str(image)


def _size(image: Image) -> str:
    height, width = image.shape
    return f"{width} x {height} px of {image.dtype}"
