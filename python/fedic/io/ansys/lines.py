"""Lines of an Ansys input file."""

import contextlib
from collections.abc import Iterator
from pathlib import Path

from fedic.errors import MeshError
from fedic.io._text import read_lines

__all__ = ["Lines"]


class Lines:
    """The lines of a file one after the other.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    MeshError
        If it cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.number = 0
        self._lines = read_lines(path)

    def next(self) -> str | None:
        """Return the next line; None after the last."""
        if self.number >= len(self._lines):
            return None
        self.number += 1
        return self._lines[self.number - 1]

    def error(self, message: str) -> MeshError:
        """Return the error to raise for the line that was returned last.

        Parameters
        ----------
        message : str
            What is wrong and what to do.

        Returns
        -------
        MeshError
            With the file and the line number.
        """
        return MeshError(f"{self.path}, line {self.number}: {message}")

    @contextlib.contextmanager
    def reported(self, command: str) -> Iterator[None]:
        """Turn a ValueError into a MeshError that names the line.

        Parameters
        ----------
        command : str
            The command that is read.

        Yields
        ------
        None
        """
        try:
            yield
        except ValueError as error:
            raise self.error(f"not a valid line of {command} ({error}).") from error
