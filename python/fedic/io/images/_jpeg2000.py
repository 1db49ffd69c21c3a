"""JPEG 2000."""

import struct

from fedic._internal.types import Image
from fedic.io.images._faults import check_size, damaged
from fedic.io.images._levels import luminance

__all__ = ["check_jpeg2000", "decode_jpeg2000"]

_START = b"\xff\x4f\xff\x51"
_END = b"\xff\xd9"


def decode_jpeg2000(data: bytes) -> Image:
    """Decode a JPEG 2000 file or codestream.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        Its grey levels.

    Raises
    ------
    ImageError
        If it is damaged or too large.
    """
    import imagecodecs

    check_jpeg2000(data)
    return luminance(imagecodecs.jpeg2k_decode(data))


def check_jpeg2000(data: bytes) -> None:
    """Refuse JPEG 2000 data that are cut, or too large once decoded.

    Parameters
    ----------
    data : bytes
        A file or codestream.

    Raises
    ------
    ImageError
        If the codestream has no beginning, no end, or is too large.
    """
    start = data.find(_START)
    if start < 0 or len(data) < start + 42:
        raise damaged("it holds no codestream of JPEG 2000")
    right, bottom, left, top = struct.unpack_from(">IIII", data, start + 8)
    (components,) = struct.unpack_from(">H", data, start + 40)
    check_size(right - left, bottom - top, 4 * components)
    if data.rfind(_END) < start:
        raise damaged("it ends before the image does")
