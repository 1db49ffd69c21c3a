"""Arrays in VTK's XML files."""

import base64
import binascii
import lzma
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from fedic.io.limits import MAX_BYTES
from fedic.io.mesh_formats._numbers import numbers_of

__all__ = ["ArrayReader"]

_TYPES = {
    **{f"{sign}Int{8 * size}": f"{kind}{size}" for sign, kind in (("", "i"), ("U", "u")) for size in (1, 2, 4, 8)},
    "Float32": "f4",
    "Float64": "f8",
}
_HEADERS = {"UInt32": "u4", "UInt64": "u8"}
_LZMA_MEMORY = 2**28


def _zlib(block: bytes, size: int) -> bytes:
    return zlib.decompressobj().decompress(block, size + 1)


def _lzma(block: bytes, size: int) -> bytes:
    return lzma.LZMADecompressor(memlimit=_LZMA_MEMORY).decompress(block, size + 1)


def _lz4(block: bytes, size: int) -> bytes:
    import imagecodecs

    return bytes(imagecodecs.lz4_decode(block, out=size))


_COMPRESSORS: dict[str, Callable[[bytes, int], bytes]] = {
    "vtkZLibDataCompressor": _zlib,
    "vtkLZMADataCompressor": _lzma,
    "vtkLZ4DataCompressor": _lz4,
}


@dataclass
class ArrayReader:
    """Reader of the arrays of one file.

    Attributes
    ----------
    attributes : dict of str to str
        Attributes of the element ``VTKFile``: byte order, type of headers, compressor.
    appended : bytes
        What follows the underscore of ``AppendedData``.
    raw : bool
        Whether that is raw; otherwise it is base64.
    offsets : list of int
        Where the appended arrays start, in ascending order.
    """

    attributes: dict[str, str]
    appended: bytes
    raw: bool
    offsets: list[int]

    def read(self, array: Element, kind: type[np.float64] | type[np.int64]) -> NDArray[Any]:
        """Return the numbers of an array.

        Parameters
        ----------
        array : Element
            The ``DataArray``.
        kind : type
            ``np.float64`` or ``np.int64``, in which they are returned.

        Returns
        -------
        ndarray, shape (n,)
            The numbers.

        Raises
        ------
        ValueError
            If the array is damaged.
        """
        name = array.get("Name", "")
        try:
            if array.get("format") == "ascii":
                # Through numbers of the kind: text of large integers would lose digits as floats.
                return numbers_of((array.text or "").split(), kind)
            numbers = self._decoded(array)
            if kind is np.int64 and numbers.dtype.kind == "f":
                raise ValueError("it does not hold integers")
            return numbers.astype(kind)
        except (ValueError, OverflowError, zlib.error, lzma.LZMAError, binascii.Error, RuntimeError) as error:
            raise ValueError(f"the array {name!r} is damaged: {error}") from error

    def _decoded(self, array: Element) -> NDArray[Any]:
        type_name = array.get("type", "")
        if type_name not in _TYPES:
            raise ValueError(f"its type {type_name!r} is unknown")
        if array.get("format") == "appended":
            start = int(array.get("offset", "-1"))
            if not 0 <= start <= len(self.appended):
                raise ValueError(f"it starts at {start}, outside the appended data")
            end = next((offset for offset in self.offsets if offset > start), len(self.appended))
            content = self.appended[start:end] if self.raw else _from_base64(self.appended[start:end])
        elif array.get("format") == "binary":
            content = _from_base64((array.text or "").encode("ascii", "replace"))
        else:
            raise ValueError(f"its format {array.get('format')!r} is unknown")
        order = ">" if self.attributes.get("byte_order") == "BigEndian" else "<"
        header = np.dtype(order + _HEADERS.get(self.attributes.get("header_type", "UInt32"), "u4"))
        return np.frombuffer(self._unpacked(content, header), order + _TYPES[type_name])

    def _unpacked(self, content: bytes, header: np.dtype[Any]) -> bytes:
        def sizes(first: int, count: int) -> list[int]:
            part = content[first * header.itemsize : (first + count) * header.itemsize]
            if len(part) < count * header.itemsize:
                raise ValueError("it ends too early")
            return [int(number) for number in np.frombuffer(part, header)]

        compressor = self.attributes.get("compressor", "")
        if not compressor:
            (size,) = sizes(0, 1)
            data = content[header.itemsize : header.itemsize + size]
            if len(data) < size:
                raise ValueError("it ends too early")
            return data
        if compressor not in _COMPRESSORS:
            raise ValueError(f"the compressor {compressor!r} is unknown")
        num_blocks, block_size, last_size = sizes(0, 3)
        packed = sizes(3, num_blocks)
        unpacked = [block_size] * num_blocks
        if num_blocks and last_size:
            unpacked[-1] = last_size
        if sum(unpacked) > MAX_BYTES:
            raise ValueError(f"it holds {sum(unpacked)} bytes, more than the {MAX_BYTES} that are read")
        place = (3 + num_blocks) * header.itemsize
        blocks = []
        for size, expected in zip(packed, unpacked, strict=True):
            block = _COMPRESSORS[compressor](content[place : place + size], expected)
            if len(block) != expected:
                raise ValueError("a compressed block has the wrong size")
            blocks.append(block)
            place += size
        return b"".join(blocks)


def _from_base64(text: bytes) -> bytes:
    """Decode parts one after the other, each of which may end in padding."""
    parts = re.findall(rb"[^=]+=*", b"".join(text.split()))
    return b"".join(base64.b64decode(part, validate=True) for part in parts)
