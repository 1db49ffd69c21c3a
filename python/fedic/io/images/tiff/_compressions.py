"""Compressions of TIFF files that are read right, and checks of compressed strips and tiles before they are decoded."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from fedic.errors import ImageError
from fedic.io.images._jpeg import check_jpeg
from fedic.io.images._jpeg2000 import check_jpeg2000
from fedic.io.images._jpegxl import check_jpegxl
from fedic.io.images._png import check_png

if TYPE_CHECKING:
    from tifffile import TiffPage

__all__ = ["JPEG", "LZW", "PACKBITS", "check_compression", "check_segment"]

LZW, PACKBITS = 5, 32773
JPEG = (7, 33007, 34892)
_FAX, _DEFLATE, _LZMA, _ZSTD, _LERC = (2, 3, 4), (8, 32946), 34925, (50000, 34926), 34887
_JPEG2000, _JPEG_XL, _PNG, _WEBP = 34712, (50002, 52546), 34933, 50001
_CHECKS: dict[int, Callable[[bytes], object]] = {
    **dict.fromkeys(JPEG, check_jpeg),
    **dict.fromkeys(_JPEG_XL, check_jpegxl),
    _JPEG2000: check_jpeg2000,
    _PNG: check_png,
}
_READ = {1, LZW, PACKBITS, *_FAX, *_DEFLATE, _LZMA, *_ZSTD, _LERC, _WEBP, *_CHECKS}
_READ_PREDICTORS = {1, 2, 3}


def check_compression(page: "TiffPage") -> None:
    """Refuse a page whose compression or predictor is not read.

    Parameters
    ----------
    page : TiffPage
        The page.

    Raises
    ------
    ImageError
        If it is not read.
    """
    import tifffile

    for value, read, name in (
        (page.compression, _READ, "compression"),
        (page.predictor, _READ_PREDICTORS, "predictor"),
    ):
        # An older tifffile does not know all of them.
        if value not in read or (name == "compression" and value not in tifffile.TIFF.DECOMPRESSORS):
            label = getattr(value, "name", "unknown")
            raise ImageError(
                f"its {name}, {label} ({int(value)}), is not read; save it uncompressed, or with LZW, deflate or ZSTD."
            )


def check_segment(page: "TiffPage", data: bytes) -> None:
    """Refuse a strip or tile that is an image of another format, and cut or too large once decoded.

    Parameters
    ----------
    page : TiffPage
        The page.
    data : bytes
        The strip or tile as stored.

    Raises
    ------
    ImageError
        If it is damaged or too large.
    """
    check = _CHECKS.get(int(page.compression))
    if check is not None:
        check(data)
