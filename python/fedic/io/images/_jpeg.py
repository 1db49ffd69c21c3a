"""JPEG: baseline and progressive of 8 bits, 12 bits, lossless, JPEG-LS."""

import struct
from dataclasses import dataclass

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._faults import check_size, damaged
from fedic.io.images._levels import luminance
from fedic.io.images._opencv import decode_with_opencv

__all__ = ["JpegFrame", "check_jpeg", "decode_jpeg"]

_START_OF_SCAN = 0xDA
_NO_FRAME = (0xC4, 0xC8, 0xCC)
"""Markers among those of frames that are none: tables and an extension."""
_LOSSY_OF_OPENCV = (0xC0, 0xC1, 0xC2, 0xC9, 0xCA)
_JPEG_LS = 0xF7
_WITHOUT_LENGTH = (0x01, *range(0xD0, 0xD9))


@dataclass(frozen=True)
class JpegFrame:
    """Kind, depth and size of a JPEG image, from its header."""

    marker: int
    bits: int
    width: int
    height: int
    components: int


def decode_jpeg(data: bytes) -> Image:
    """Decode a JPEG file.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    ndarray of uint8 or uint16, shape (height, width)
        Its grey levels, in the rows and columns of the sensor.

    Raises
    ------
    ImageError
        If it is damaged, too large, or of a kind that is not read.
    """
    frame = check_jpeg(data)
    if frame.bits == 8 and frame.marker in _LOSSY_OF_OPENCV:
        return decode_with_opencv(data)
    if frame.components not in (1, 3):
        raise ImageError(
            f"this JPEG image has {frame.components} components of {frame.bits} bits; save it as grey or RGB."
        )
    import imagecodecs

    if frame.marker == _JPEG_LS:
        return luminance(imagecodecs.jpegls_decode(data))
    return luminance(imagecodecs.jpeg_decode(data, bitspersample=frame.bits))


def check_jpeg(data: bytes) -> JpegFrame:
    """Refuse JPEG data that end before the image does, or are too large once decoded.

    Parameters
    ----------
    data : bytes
        A whole JPEG image.

    Returns
    -------
    JpegFrame
        What its header states.

    Raises
    ------
    ImageError
        If the header or the marker of the end is missing, or the image is too large.
    """
    frame = _frame(data)
    check_size(frame.width, frame.height, frame.components * (1 if frame.bits <= 8 else 2))
    # Neither marker can occur inside the compressed data, where 0xFF is escaped.
    if not data.rfind(b"\xff\xd9") > data.rfind(b"\xff\xda") > 0:
        raise damaged("it ends before the image does")
    return frame


def _frame(data: bytes) -> JpegFrame:
    position = 2
    while position + 4 <= len(data) and data[position] == 0xFF:
        marker = data[position + 1]
        if marker == 0xFF:
            position += 1
        elif marker in _WITHOUT_LENGTH:
            position += 2
        elif marker == _START_OF_SCAN:
            break
        else:
            if (0xC0 <= marker <= 0xCF and marker not in _NO_FRAME) or marker == _JPEG_LS:
                if position + 10 > len(data):
                    break
                bits, height, width, components = struct.unpack_from(">BHHB", data, position + 4)
                return JpegFrame(marker, bits, width, height, components)
            position += 2 + int.from_bytes(data[position + 2 : position + 4], "big")
    raise damaged("its header is incomplete")
