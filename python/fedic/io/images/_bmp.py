"""BMP."""

import struct

from fedic._internal.types import Image
from fedic.io.images._faults import check_size, damaged
from fedic.io.images._opencv import decode_with_opencv

__all__ = ["decode_bmp"]

_UNCOMPRESSED = (0, 3)
_OS2_HEADER_BYTES = 12
_HEADER_BYTES = (12, 16, 40, 52, 56, 64, 108, 124)


def decode_bmp(data: bytes) -> Image:
    """Decode a BMP file.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    ndarray of uint8, shape (height, width)
        Its grey levels.

    Raises
    ------
    ImageError
        If it is damaged or too large.
    """
    if len(data) < 26:
        raise damaged("it ends within its header")
    offset, header_bytes = struct.unpack_from("<II", data, 10)
    if header_bytes not in _HEADER_BYTES:
        raise damaged(f"its header states a length of {header_bytes} bytes")
    compression = 0
    if header_bytes == _OS2_HEADER_BYTES:
        width, height, _, depth = struct.unpack_from("<HHHH", data, 18)
    elif len(data) < 54:
        raise damaged("it ends within its header")
    else:
        width, height, _, depth, compression = struct.unpack_from("<iiHHI", data, 18)
    check_size(width, abs(height), bytes_per_pixel=4)
    row_bytes = (width * depth + 31) // 32 * 4
    if compression in _UNCOMPRESSED and offset + row_bytes * abs(height) > len(data):
        raise damaged("it ends before the image does")
    return decode_with_opencv(data)
