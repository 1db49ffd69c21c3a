"""Formats of image files, recognised by their first bytes."""

from collections.abc import Callable
from pathlib import Path

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._bmp import decode_bmp
from fedic.io.images._foreign import refusal
from fedic.io.images._jpeg import decode_jpeg
from fedic.io.images._jpeg2000 import decode_jpeg2000
from fedic.io.images._jpegxl import decode_jpegxl
from fedic.io.images._netpbm import decode_netpbm
from fedic.io.images._npy import read_npy
from fedic.io.images._png import decode_png
from fedic.io.images._webp import decode_webp
from fedic.io.images.tiff import read_tiff

__all__ = ["HEADER_BYTES", "recognise"]

HEADER_BYTES = 512
"""Bytes at the start of a file that tell its format."""

Reader = Callable[[Path, int | None, bool], Image]

_TIFF = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_SINGLE: dict[bytes, Callable[[bytes], Image]] = {
    b"\x89PNG\r\n\x1a\n": decode_png,
    b"\xff\xd8\xff": decode_jpeg,
    b"\x00\x00\x00\x0cjP  ": decode_jpeg2000,
    b"\xff\x4f\xff\x51": decode_jpeg2000,
    b"\x00\x00\x00\x0cJXL ": decode_jpegxl,
    b"\xff\x0a": decode_jpegxl,
    **dict.fromkeys((b"P1", b"P2", b"P3", b"P4", b"P5", b"P6", b"PF", b"Pf"), decode_netpbm),
    b"BM": decode_bmp,
}
"""Decoders of files that hold one image, by the bytes they begin with."""


def recognise(header: bytes, path: Path) -> Reader:
    """Return the reader of a file.

    Parameters
    ----------
    header : bytes
        The first `HEADER_BYTES` of the file, or all of a shorter one.
    path : Path
        Its name, which only tells what a format that is not read may be.

    Returns
    -------
    callable
        Called with the file, the number of the page or None, and whether to map the file.

    Raises
    ------
    ImageError
        If the format is not read.
    """
    if header.startswith(_TIFF) and header[8:10] != b"CR":
        return read_tiff
    if header.startswith(b"\x93NUMPY"):
        return read_npy
    if header.startswith(b"RIFF") and header[8:12] == b"WEBP":
        return _single(decode_webp)
    for signature, decode in _SINGLE.items():
        if header.startswith(signature):
            return _single(decode)
    raise refusal(header, path)


def _single(decode: Callable[[bytes], Image]) -> Reader:
    def read(path: Path, page: int | None, mapped: bool) -> Image:
        if page:
            raise ImageError(f"page {page} does not exist: the file holds one image.")
        return decode(path.read_bytes())

    return read
