"""PBM, PGM, PPM and PFM."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._faults import check_size, damaged
from fedic.io.images._levels import luminance

__all__ = ["decode_netpbm"]

_GAP = rb"(?:\s|#[^\n\r]*[\n\r])+"
_HEADER = re.compile(rb"P([1-6fF])" + _GAP + rb"([0-9]{1,9})" + _GAP + rb"([0-9]{1,9})")
_HIGHEST = re.compile(_GAP + rb"([0-9]{1,5})")
_SCALE = re.compile(_GAP + rb"([-+]?[0-9.eE+-]{1,40})")
_COMMENT = re.compile(rb"#[^\n\r]*")
_MAX_HIGHEST = 65535


@dataclass(frozen=True)
class _Header:
    kind: str
    width: int
    height: int
    channels: int
    highest: int
    """The largest grey level."""
    byte_order: str
    body: int
    """Where the samples begin."""


def decode_netpbm(data: bytes) -> Image:
    """Decode a PBM, PGM, PPM or PFM file.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        Its grey levels as stored; of PBM, 0 for black and 1 for white.

    Raises
    ------
    ImageError
        If it is damaged, too large, or holds several images.
    """
    header = _read_header(data)
    shape = header.height, header.width, header.channels
    check_size(header.width, header.height, 4 * header.channels)
    if header.kind in "123":
        samples = _text_samples(header, data)
    elif header.kind == "4":
        row_bytes = (header.width + 7) // 8
        packed = _binary(data, header.body, np.dtype(np.uint8), header.height * row_bytes)
        samples = 1 - np.unpackbits(packed.reshape(header.height, row_bytes), axis=1, count=header.width)
    elif header.kind in "fF":
        samples = _binary(data, header.body, np.dtype(f"{header.byte_order}f4"), int(np.prod(shape)))
        return luminance(samples.reshape(shape)[::-1])
    else:
        dtype = np.dtype(np.uint8 if header.highest < 256 else ">u2")
        samples = _binary(data, header.body, dtype, int(np.prod(shape)))
    if samples.size != np.prod(shape) or samples.max() > header.highest:
        raise damaged("its samples do not agree with its header")
    return luminance(samples.reshape(shape).astype(np.uint8 if header.highest < 256 else np.uint16))


def _read_header(data: bytes) -> _Header:
    match = _HEADER.match(data)
    if match is None:
        raise damaged("its header is not that of a PBM, PGM, PPM or PFM file")
    kind = match[1].decode()
    highest, byte_order, end = 1, ">", match.end()
    if kind not in "14":
        last = (_SCALE if kind in "fF" else _HIGHEST).match(data, end)
        if last is None:
            raise damaged("its header ends early")
        end = last.end()
        if kind in "fF":
            byte_order = "<" if float(last[1]) < 0 else ">"
        else:
            highest = int(last[1])
    if not 0 < highest <= _MAX_HIGHEST:
        raise damaged(f"its header states {highest} as the largest grey level")
    channels = 3 if kind in "36F" else 1
    return _Header(kind, int(match[2]), int(match[3]), channels, highest, byte_order, end + 1)


def _binary(data: bytes, start: int, dtype: np.dtype[Any], count: int) -> NDArray[Any]:
    end = start + count * dtype.itemsize
    if end > len(data):
        raise damaged("it ends before the image does")
    if data[end:].strip(b"\0\t\n\r "):
        raise ImageError("the file holds more than one image; save each in its own file.")
    return np.frombuffer(data, dtype, count, start)


def _text_samples(header: _Header, data: bytes) -> NDArray[Any]:
    text = _COMMENT.sub(b" ", data[header.body :])
    if header.kind == "1":
        digits = np.frombuffer(b"".join(text.split()), np.uint8) - np.uint8(ord("0"))
        if digits.size and digits.max() > 1:
            raise damaged("its samples are not 0 or 1")
        return np.asarray(1 - digits)
    words = text.split()
    if any(len(word) > 5 or not word.isdigit() for word in words):
        raise damaged("its samples are not numbers")
    return np.array(words, dtype=np.bytes_).astype(np.int64) if words else np.empty(0, np.int64)
