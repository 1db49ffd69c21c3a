"""Files that a mesh file includes, within limits on their number, depth and size."""

from pathlib import Path, PureWindowsPath

from fedic.errors import MeshError
from fedic.io.limits import MAX_BYTES
from fedic.io.mesh_formats._lines import line_error, read_lines

__all__ = ["MAX_DEPTH", "MAX_FILES", "Includes"]

MAX_DEPTH = 20
"""Largest number of files that include each other in a chain."""
MAX_FILES = 1000
"""Largest number of files that one mesh is read from."""


class Includes:
    """The main file and those that it includes.

    Parameters
    ----------
    main : Path
        The main file.
    """

    def __init__(self, main: Path) -> None:
        self.main = main
        self._count = 0
        self._bytes = MAX_BYTES

    def read(self, path: Path) -> list[str]:
        """Return the lines of a file.

        Parameters
        ----------
        path : Path
            The file.

        Returns
        -------
        list of str
            The lines without their ends.

        Raises
        ------
        MeshError
            If the file cannot be read, or the files are too many or too large.
        """
        self._count += 1
        if self._count > MAX_FILES:
            raise MeshError(f"{self.main}: more than {MAX_FILES} files are included; join them to fewer.")
        lines = read_lines(path, self._bytes)
        self._bytes -= sum(map(len, lines))
        return lines

    def find(self, name: str, number: int, including: tuple[Path, ...]) -> Path:
        """Return the path of a file that a line includes.

        Parameters
        ----------
        name : str
            The name in the line; folders are parted by slashes or backslashes.
        number : int
            Number of the line in the last of the files that led here.
        including : tuple of Path
            The files that led here, from the main file on.

        Returns
        -------
        Path
            The file beside the one with the line, or else beside the main file.

        Raises
        ------
        MeshError
            If there is no such file, it is no regular file, it includes itself, or the depth is exceeded.
        """
        names = (name, PureWindowsPath(name).as_posix())
        candidates = [folder / each for folder in (including[-1].parent, self.main.parent) for each in names]
        found = next((path for path in candidates if _exists(path)), None)
        if found is None:
            raise line_error(
                including[-1], number, f"the included file {name!r} does not exist; put it beside this file."
            )
        if not found.is_file():
            raise line_error(including[-1], number, f"{found} is no regular file; only files can be included.")
        if found.resolve() in {path.resolve() for path in including}:
            raise line_error(including[-1], number, f"{found}: the file includes itself through this line; remove it.")
        if len(including) >= MAX_DEPTH:
            raise line_error(
                including[-1], number, f"files include each other {MAX_DEPTH} deep and deeper; join some of them."
            )
        return found


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):
        return False
