"""Lines of an Abaqus input file."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from fedic.errors import MeshError

__all__ = ["Line", "reported", "split_items"]


class Line(NamedTuple):
    """One line: its file, its number there, and its text without blanks at the ends."""

    source: Path
    number: int
    text: str

    def error(self, message: str) -> MeshError:
        """Return the error to raise for this line.

        Parameters
        ----------
        message : str
            What is wrong and what to do.

        Returns
        -------
        MeshError
            With the file and the line number.
        """
        return MeshError(f"{self.source}, line {self.number}: {message}")

    def items(self) -> list[str]:
        """Return what stands between the commas, without an empty item at the end."""
        items = split_items(self.text)
        return items[:-1] if items and not items[-1] else items


@contextlib.contextmanager
def reported(line: Line, keyword: str) -> Iterator[None]:
    """Turn a ValueError into a MeshError that names the line.

    Parameters
    ----------
    line : Line
        The line that is read.
    keyword : str
        The keyword that it belongs to.

    Yields
    ------
    None
    """
    try:
        yield
    except ValueError as error:
        raise line.error(f"not a valid line of *{keyword} ({error}).") from error


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
