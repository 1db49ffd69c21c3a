"""JPEG XL."""

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._faults import check_size, damaged
from fedic.io.images._levels import luminance

__all__ = ["check_jpegxl", "decode_jpegxl"]

_CODESTREAM = b"\xff\x0a"
_BOXES = {b"jxlc": 0, b"jxlp": 4}
"""Boxes that hold the codestream, and the bytes in front of it."""
_RATIOS = {1: (1, 1), 2: (12, 10), 3: (4, 3), 4: (3, 2), 5: (16, 9), 6: (5, 4), 7: (2, 1)}
_SIZE_BITS = (9, 13, 18, 30)


def decode_jpegxl(data: bytes) -> Image:
    """Decode a JPEG XL file or codestream.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        Its grey levels, in the rows and columns of the sensor.

    Raises
    ------
    ImageError
        If it is damaged, too large or animated.
    """
    import imagecodecs

    size = check_jpegxl(data)
    samples = imagecodecs.jpegxl_decode(data, keeporientation=True)
    if samples.shape[:2] != size:
        raise ImageError("this JPEG XL file holds several frames; save each of them in its own file.")
    return luminance(samples)


def check_jpegxl(data: bytes) -> tuple[int, int]:
    """Return the size that the header of JPEG XL data states.

    Parameters
    ----------
    data : bytes
        A file or codestream.

    Returns
    -------
    (int, int)
        Height and width.

    Raises
    ------
    ImageError
        If it has no codestream or is too large once decoded.
    """
    start = 0 if data.startswith(_CODESTREAM) else -1
    for box, skipped in _BOXES.items():
        if start < 0 and (place := data.find(box)) >= 0:
            start = place + len(box) + skipped
    if start < 0 or data[start : start + 2] != _CODESTREAM:
        raise damaged("it holds no codestream of JPEG XL")
    bits = _Bits(data[start + 2 : start + 18])
    small = bits.take(1)
    height = _dimension(bits, small)
    ratio = bits.take(3)
    width = height * _RATIOS[ratio][0] // _RATIOS[ratio][1] if ratio else _dimension(bits, small)
    check_size(width, height, bytes_per_pixel=4)
    return height, width


def _dimension(bits: "_Bits", small: int) -> int:
    return 8 * (bits.take(5) + 1) if small else bits.take(_SIZE_BITS[bits.take(2)]) + 1


class _Bits:
    """Bits of a header, the least significant of each byte first."""

    def __init__(self, data: bytes) -> None:
        self._rest = int.from_bytes(data, "little")

    def take(self, count: int) -> int:
        """Return the next bits as a number."""
        value = self._rest & ((1 << count) - 1)
        self._rest >>= count
        return value
