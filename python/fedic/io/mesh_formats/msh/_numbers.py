"""Numbers in a section of a Gmsh file, as text or binary."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic.io.mesh_formats._numbers import numbers_of

__all__ = ["Numbers"]

_BINARY = {"int": "i4", "size": "u8", "double": "f8"}
_LARGEST_EXACT = 2**53
"""Larger integers written as text cannot be told apart."""


class Numbers:
    """The numbers of a section, taken one after the other.

    Parameters
    ----------
    content : bytes
        The section, without its first and last line.
    binary : bool
        True for binary files.
    order : str
        Byte order of a binary file: ``"<"`` or ``">"``.
    section : str
        Name of the section, for messages.

    Raises
    ------
    ValueError
        Here and in `take`, if the section ends too early or holds something else than numbers.
    """

    def __init__(self, content: bytes, binary: bool, order: str, section: str) -> None:
        self._binary = binary
        self._order = order
        self._section = section
        self._place = 0
        self._content: bytes | NDArray[np.float64] = content
        if not binary:
            try:
                self._content = numbers_of(content.split(), np.float64)
            except ValueError as error:
                raise ValueError(f"in the section {section}, {error}") from error

    def take(self, kind: str, *shape: int) -> NDArray[Any]:
        """Return the next numbers.

        Parameters
        ----------
        kind : str
            ``"int"`` (4 bytes), ``"size"`` (8 bytes) or ``"double"``.
        shape : int
            Shape of the array.

        Returns
        -------
        ndarray of int64 or float64
            The numbers.
        """
        *lengths, width = map(int, shape)  # sizes come from the file: Python's integers do not overflow
        (columns,) = self.records(math.prod(lengths), (kind, width))
        return columns.reshape(shape)

    def records(self, count: int, *columns: tuple[str, int]) -> list[NDArray[Any]]:
        """Return the next records: rows that hold numbers of several kinds.

        Parameters
        ----------
        count : int
            Number of records.
        columns : tuple of (str, int)
            Kind and number of the numbers in a record, one pair after the other.

        Returns
        -------
        list of ndarray of int64 or float64, shape (count, number)
            The numbers of each pair.
        """
        layout = np.dtype([(str(i), self._order + _BINARY[kind], (n,)) for i, (kind, n) in enumerate(columns)])
        width = layout.itemsize if self._binary else sum(number for _, number in columns)
        end = self._place + count * width
        if count < 0 or end > len(self._content):
            raise ValueError(f"the section {self._section} ends before all its numbers; the file is damaged")
        part = self._content[self._place : end]
        self._place = end
        if isinstance(part, bytes):
            rows = np.frombuffer(part, layout) if width else np.empty(count, layout)
            found = [rows[str(index)] for index in range(len(columns))]
        else:
            found = np.split(part.reshape(count, width), np.cumsum([number for _, number in columns])[:-1], axis=1)
        return [
            each.astype(np.float64) if kind == "double" else self._integers(each)
            for each, (kind, _) in zip(found, columns, strict=True)
        ]

    def one(self, kind: str) -> int:
        """Return the next number as an integer.

        Parameters
        ----------
        kind : str
            As in `take`.

        Returns
        -------
        int
            The number.
        """
        return int(self.take(kind, 1)[0])

    def rest(self) -> NDArray[np.int64]:
        """Return all numbers that remain in a section of text, as integers.

        Returns
        -------
        ndarray of int64, shape (n,)
            The numbers.
        """
        return self._integers(np.asarray(self._content[self._place :]))

    def _integers(self, values: NDArray[Any]) -> NDArray[np.int64]:
        if values.dtype.kind == "f":
            wrong = ~((np.abs(values) < _LARGEST_EXACT) & (values == np.trunc(values)))
            if wrong.any():
                raise ValueError(
                    f"in the section {self._section}, {values[wrong][0]} stands where an integer is expected"
                )
        return values.astype(np.int64)
