"""Lines and numbers of VTK's legacy format."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic.io.mesh_formats._numbers import numbers_of

__all__ = ["Tokens"]

_TYPES = {
    "char": "i1",
    "signed_char": "i1",
    "unsigned_char": "u1",
    "short": "i2",
    "unsigned_short": "u2",
    "int": "i4",
    "unsigned_int": "u4",
    "long": "i8",
    "unsigned_long": "u8",
    "vtkidtype": "i4",
    "vtktypeint64": "i8",
    "vtktypeuint64": "u8",
    "vtktypeint32": "i4",
    "float": "f4",
    "double": "f8",
}
_LENGTHS = {0b11: (1, 0x3F), 0b10: (2, 0x3FFF), 0b01: (4, 0x3FFFFFFF), 0b00: (8, 2**62 - 1)}
"""Length of a binary string: number of its bytes and mask, by the first two bits."""


class Tokens:
    """The content of a file and a place in it.

    Attributes
    ----------
    binary : bool
        Whether numbers are binary, most significant byte first.
    """

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._place = 0
        self.binary = False

    def raw_line(self) -> str:
        """Return the next line, which may be empty.

        Returns
        -------
        str
            The line without its end.
        """
        end = self._content.find(b"\n", self._place)
        end = len(self._content) if end < 0 else end
        line = self._content[self._place : end]
        self._place = min(end + 1, len(self._content))
        return line.decode("utf-8", "replace").rstrip("\r")

    def line(self) -> str:
        """Return the next line that is not empty.

        Returns
        -------
        str
            The line, empty at the end of the file.
        """
        while self._place < len(self._content):
            line = self.raw_line().strip()
            if line:
                return line
        return ""

    def skip_to_empty_line(self) -> None:
        """Pass the lines up to the next empty one."""
        while self._place < len(self._content) and self.raw_line().strip():
            pass

    def numbers(self, count: int, kind: str) -> NDArray[Any]:
        """Return the next numbers.

        Parameters
        ----------
        count : int
            How many.
        kind : str
            Their type as the file names it.

        Returns
        -------
        ndarray, shape (count,)
            The numbers.
        """
        kind = kind.lower()
        if kind == "bit":
            return self._bits(count)
        if kind not in _TYPES:
            raise ValueError(f"numbers of type {kind[:40]!r} are not read")
        size = int(_TYPES[kind][1]) if self.binary else 1
        if count * size > len(self._content) - self._place:
            raise ValueError(f"the file ends before {count} numbers of type {kind}; it is damaged")
        if self.binary:
            return np.frombuffer(self._bytes(count * size), ">" + _TYPES[kind])
        items = self._content[self._place :].split(None, count)
        rest = len(items[count]) if len(items) > count else 0
        self._place = len(self._content) - rest
        if len(items) < count:
            raise ValueError(f"the file ends before {count} numbers of type {kind}; it is damaged")
        # Text is read as the numbers it spells, whatever type the file names.
        return numbers_of(items[:count], np.float64 if _TYPES[kind][0] == "f" else np.int64)

    def skip_strings(self, count: int) -> None:
        """Pass strings: lines of text, or binary strings after their length.

        Parameters
        ----------
        count : int
            How many.
        """
        for _ in range(count):
            if self._place >= len(self._content):
                raise ValueError("the file ends before all strings of an array; it is damaged")
            if not self.binary:
                self.raw_line()
                continue
            size, mask = _LENGTHS[self._content[self._place] >> 6]
            self._bytes(int.from_bytes(self._bytes(size), "big") & mask)

    def _bits(self, count: int) -> NDArray[Any]:
        if not self.binary:
            return self.numbers(count, "int")
        packed = np.frombuffer(self._bytes((count + 7) // 8), np.uint8)
        return np.unpackbits(packed)[:count]

    def _bytes(self, count: int) -> bytes:
        part = self._content[self._place : self._place + count]
        if len(part) < count:
            raise ValueError("the file ends before all its numbers; it is damaged")
        self._place += count
        return part
