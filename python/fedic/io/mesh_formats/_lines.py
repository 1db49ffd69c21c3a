"""Lines of mesh files: how they are read, and errors that name them."""

import contextlib
from collections.abc import Iterator
from pathlib import Path

from fedic.errors import MeshError
from fedic.io.files import read_start
from fedic.io.limits import MAX_BYTES
from fedic.io.text import decoded

__all__ = ["Located", "first_lines", "line_error", "read_lines"]

_HEAD = 1 << 18


class Located:
    """What stands in a line of a file, with errors that say so.

    Attributes
    ----------
    source : Path
        The file.
    number : int
        Number of the line, counted from 1.
    """

    __slots__ = ()
    source: Path
    number: int

    def error(self, message: str) -> MeshError:
        """Return the error to raise for the line; the parameter is what is wrong and what to do."""
        return line_error(self.source, self.number, message)

    @contextlib.contextmanager
    def reported(self, name: str) -> Iterator[None]:
        """Turn a ValueError into a MeshError that names the line.

        Parameters
        ----------
        name : str
            The command or keyword that is read.

        Yields
        ------
        None
        """
        try:
            yield
        except ValueError as error:
            raise self.error(f"not a valid line of {name} ({error}).") from error


def line_error(source: Path, number: int, message: str) -> MeshError:
    """Return the error to raise for a line of a file.

    Parameters
    ----------
    source : Path
        The file.
    number : int
        Number of the line, counted from 1.
    message : str
        What is wrong and what to do.

    Returns
    -------
    MeshError
        With the file and the line number.
    """
    return MeshError(f"{source}, line {number}: {message}")


def read_lines(path: Path, limit: int = MAX_BYTES) -> list[str]:
    r"""Return the lines of a text file.

    Lines end with ``\n``, ``\r\n`` or ``\r``.

    Parameters
    ----------
    path : Path
        The file.
    limit : int
        Largest size in bytes.

    Returns
    -------
    list of str
        The lines without their ends.

    Raises
    ------
    MeshError
        If the file is missing, is no regular file, is larger than the limit or is not text.
    """
    data = read_start(path, limit + 1, MeshError, "mesh file")
    if len(data) > limit:
        raise MeshError(
            f"{path}: the mesh and the files it includes are larger than {MAX_BYTES >> 30} GiB; "
            "export only what is correlated."
        )
    text = decoded(data, "replace")
    if "\0" in text:
        raise MeshError(f"{path}: this is a binary file, not text; export the mesh as text.")
    return _split(text)


def first_lines(path: Path) -> list[str]:
    """Return the lines at the beginning of a file, of which the last may be cut.

    Parameters
    ----------
    path : Path
        The file, text or not.

    Returns
    -------
    list of str
        The lines of the first 256 KiB, without their ends.

    Raises
    ------
    MeshError
        If the file is missing or is no regular file.
    """
    return _split(decoded(read_start(path, _HEAD, MeshError, "mesh file"), "replace"))


def _split(text: str) -> list[str]:
    return text.rstrip("\x1a").replace("\r\n", "\n").replace("\r", "\n").split("\n")
