"""Lines of an Abaqus input file."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fedic.io.mesh_formats._lines import Located

__all__ = ["Line", "number_table", "split_items"]

_Number = TypeVar("_Number", np.float64, np.int64)


@dataclass(slots=True)
class Line(Located):
    """One line: its file, its number there, and its text without blanks at the ends."""

    source: Path
    number: int
    text: str

    def items(self) -> list[str]:
        """Return what stands between the commas, without an empty item at the end."""
        items = split_items(self.text)
        return items[:-1] if items and not items[-1] else items


def number_table(lines: Sequence[Line], kind: type[_Number]) -> NDArray[_Number] | None:
    """Return the numbers of lines that all hold equally many plain numbers; None if any line is not like that.

    Parameters
    ----------
    lines : sequence of Line
        The lines.
    kind : type
        ``numpy.float64`` or ``numpy.int64``.

    Returns
    -------
    ndarray, shape (n, k), or None
        One line per row. It is faster than to read item by item.
    """
    if not lines:
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # of whole numbers with a decimal point
        try:
            return np.loadtxt([line.text for line in lines], dtype=kind, delimiter=",", comments=None, ndmin=2)
        except (ValueError, OverflowError, DeprecationWarning):
            return None


def split_items(text: str) -> list[str]:
    """Return what stands between the commas of a line; commas in quotation marks do not count.

    Parameters
    ----------
    text : str
        The line.

    Returns
    -------
    list of str
        The items without blanks at their ends, quotation marks kept.
    """
    if '"' in text:
        parts = text.split('"')
        parts[1::2] = [part.replace(",", "\0") for part in parts[1::2]]
        text = '"'.join(parts)
    return [item.strip().replace("\0", ",") for item in text.split(",")]
