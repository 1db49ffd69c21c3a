"""PNG."""

import struct
import zlib

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._faults import check_size, damaged
from fedic.io.images._opencv import decode_with_opencv

__all__ = ["check_png", "decode_png"]

_SIGNATURE_BYTES = 8


def decode_png(data: bytes) -> Image:
    """Decode a PNG file.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    ndarray of uint8 or uint16, shape (height, width)
        Its grey levels; those of 1, 2 and 4 bits are scaled to 8 bits, as the format says.

    Raises
    ------
    ImageError
        If it is damaged, too large or animated.
    """
    check_png(data)
    return decode_with_opencv(data)


def check_png(data: bytes) -> None:
    """Refuse PNG data that are damaged, or too large once decoded.

    Parameters
    ----------
    data : bytes
        A whole PNG image.

    Raises
    ------
    ImageError
        If a checksum is wrong, the end is missing, the image is too large or animated.
    """
    position = _SIGNATURE_BYTES
    while True:
        if position + 12 > len(data):
            raise damaged("it ends before the image does")
        length, kind = struct.unpack_from(">I4s", data, position)
        body = position + 8
        if body + length + 4 > len(data):
            raise damaged("it ends before the image does")
        (checksum,) = struct.unpack_from(">I", data, body + length)
        if zlib.crc32(memoryview(data)[position + 4 : body + length]) != checksum:
            raise damaged("a checksum is wrong")
        if kind == b"IHDR" and length >= 8:
            width, height = struct.unpack_from(">II", data, body)
            check_size(width, height, bytes_per_pixel=8)
        if kind == b"acTL" and length >= 4 and struct.unpack_from(">I", data, body)[0] > 1:
            raise ImageError("this is an animated PNG; save each of its frames in its own file.")
        if kind == b"IEND":
            return
        position = body + length + 4
