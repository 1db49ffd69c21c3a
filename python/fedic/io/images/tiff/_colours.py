"""Grey levels from the samples of a TIFF page, by its photometric interpretation."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._faults import damaged
from fedic.io.images._levels import luminance
from fedic.io.images.tiff._compressions import JPEG

if TYPE_CHECKING:
    from tifffile import TiffPage

__all__ = ["colour_samples", "grey_levels"]

_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB, _PALETTE, _YCBCR = 0, 1, 2, 3, 6
_COLOUR_SAMPLES = {_WHITE_IS_ZERO: 1, _BLACK_IS_ZERO: 1, _RGB: 3, _PALETTE: 1, _YCBCR: 3}
_SENSOR_COLOURS = (32803, 34892)
_UNSIGNED = (1, 4)
_PHOTOMETRIC = 262
_FULL_RANGE = (0, 1, 255, 1, 128, 1, 255, 1, 128, 1, 255, 1)
_REFERENCE_BLACK_WHITE, _YCBCR_COEFFICIENTS = 532, 529
_REC_601 = (299, 1000, 587, 1000, 114, 1000)


def colour_samples(page: "TiffPage") -> int:
    """Return how many of the samples of a pixel are its grey level or colour; the rest, such as alpha, is left out.

    Parameters
    ----------
    page : TiffPage
        The page.

    Returns
    -------
    int
        1 or 3.

    Raises
    ------
    ImageError
        If the photometric interpretation is not read, or contradicts the number of samples.
    """
    kind = _kind(page)
    if kind in _SENSOR_COLOURS:
        raise ImageError(
            f"it holds the raw colours of a sensor ({_name(page)}), which need developing; export a linear 16-bit TIFF "
            "from the camera's software."
        )
    if kind not in _COLOUR_SAMPLES:
        raise ImageError(
            f"its photometric interpretation is {_name(page)}, which has no grey levels of its own; save the image as "
            "grey or RGB."
        )
    needed, extra = _COLOUR_SAMPLES[kind], len(page.extrasamples)
    if page.samplesperpixel < needed or (page.samplesperpixel > needed + extra and page.samplesperpixel > needed + 1):
        raise ImageError(
            f"it has {page.samplesperpixel} samples per pixel, {extra} of them extra, and its photometric "
            f"interpretation, {_name(page)}, needs {needed}; save the image as grey or RGB."
        )
    if kind == _WHITE_IS_ZERO and page.sampleformat not in _UNSIGNED:
        raise ImageError(
            f"its photometric interpretation is {_name(page)}, which has no meaning for {page.dtype} values; save the "
            "image with black as 0."
        )
    if kind == _YCBCR and page.compression not in JPEG:
        for tag, usual in ((_REFERENCE_BLACK_WHITE, _FULL_RANGE), (_YCBCR_COEFFICIENTS, _REC_601)):
            if tuple(page.tags.valueof(tag, usual)) != usual or page.is_subsampled:
                raise ImageError("its colours are YCbCr of an unusual kind; save the image as grey or RGB.")
    return needed


def grey_levels(page: "TiffPage", samples: NDArray[Any]) -> Image:
    """Convert the samples of a page.

    Parameters
    ----------
    page : TiffPage
        The page, which passed `colour_samples`.
    samples : ndarray, shape (height, width, samples)
        Its samples.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        Black is 0.

    Raises
    ------
    ImageError
        If the samples are of a type that is not read, or beyond the palette.
    """
    kind = _kind(page)
    if kind == _RGB or (kind == _YCBCR and page.compression in JPEG):
        return luminance(samples[:, :, :3])
    first = samples[:, :, 0]
    if kind == _WHITE_IS_ZERO:
        first = ~first if first.dtype == bool else first.dtype.type((1 << page.bitspersample) - 1) - first
    elif kind == _PALETTE:
        first = _through_palette(page, first)
    return luminance(first)


def _kind(page: "TiffPage") -> int:
    if _PHOTOMETRIC in page.tags:
        return int(page.photometric)
    return _RGB if page.samplesperpixel in (3, 4) else _BLACK_IS_ZERO


def _name(page: "TiffPage") -> str:
    kind = page.photometric
    return f"{getattr(kind, 'name', 'unknown')} ({int(kind)})"


def _through_palette(page: "TiffPage", index: NDArray[Any]) -> NDArray[Any]:
    palette = page.colormap
    if palette is None or index.dtype.kind not in "bu":
        raise damaged("it has no palette")
    grey = luminance(_in_own_depth(np.asarray(palette, dtype=np.uint16).T)[None])[0]
    if index.max(initial=0) >= len(grey):
        raise damaged("it uses colours beyond its palette")
    return np.asarray(grey[index.astype(np.uint16)])


def _in_own_depth(palette: NDArray[np.uint16]) -> NDArray[Any]:
    """Reduce a palette of 8-bit colours, which files store in several ways, to 8 bits."""
    if not (palette % 257).any():
        return (palette // 257).astype(np.uint8)
    if not (palette & 0xFF).any():
        return (palette >> 8).astype(np.uint8)
    return palette.astype(np.uint8) if palette.max() < 256 else palette
