"""Lines of an Abaqus input file and of the files that it includes."""

import contextlib
from collections.abc import Iterator
from pathlib import Path, PureWindowsPath
from typing import NamedTuple

from fedic.errors import MeshError
from fedic.io._text import MAX_BYTES, read_lines

__all__ = ["Files", "Line", "reported", "split_items"]

MAX_DEPTH = 20
MAX_FILES = 1000


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


class Files:
    """The main file and those that it includes, within limits on their number, depth and size.

    Parameters
    ----------
    main : Path
        The main file.
    """

    def __init__(self, main: Path) -> None:
        self.main = main
        self._count = 0
        self._bytes = MAX_BYTES

    def read(self, path: Path) -> Iterator[Line]:
        """Yield the lines of a file without blank lines and comments.

        Parameters
        ----------
        path : Path
            The file.

        Yields
        ------
        Line
            The lines in their order.

        Raises
        ------
        MeshError
            If the file cannot be read, or a limit is exceeded.
        """
        self._count += 1
        if self._count > MAX_FILES:
            raise MeshError(f"{self.main}: more than {MAX_FILES} files are included; join them to fewer.")
        lines = read_lines(path, self._bytes)
        self._bytes -= sum(map(len, lines))
        for number, raw in enumerate(lines, start=1):
            text = raw.strip()
            if text and not text.startswith("**"):
                yield Line(path, number, text)

    def included(self, name: str, line: Line, including: tuple[Path, ...]) -> Path:
        """Return the path of a file that a line includes.

        Parameters
        ----------
        name : str
            The name in the line; folders are parted by slashes or backslashes.
        line : Line
            The line.
        including : tuple of Path
            The files that led here, from the main file on.

        Returns
        -------
        Path
            The file beside the file of the line, or else beside the main file.

        Raises
        ------
        MeshError
            If there is no such file, it is no regular file, it includes itself, or the depth is exceeded.
        """
        names = [name, PureWindowsPath(name).as_posix()]
        folders = [line.source.parent, self.main.parent]
        candidates = [folder / each for folder in folders for each in names]
        found = next((path for path in candidates if _exists(path)), None)
        if found is None:
            raise line.error(f"the file {name!r} that it names does not exist; put it beside this file.")
        if not found.is_file():
            raise line.error(f"{found} is no regular file; only files can be included.")
        if found.resolve() in {path.resolve() for path in including}:
            raise line.error(f"{found}: the file includes itself through *INCLUDE; remove that line.")
        if len(including) >= MAX_DEPTH:
            raise line.error(f"files are included {MAX_DEPTH} deep and deeper; join some of them.")
        return found


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):
        return False
