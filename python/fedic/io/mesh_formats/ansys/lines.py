"""Lines of an Ansys input file."""

from pathlib import Path

from fedic.io.mesh_formats._lines import Located, read_lines

__all__ = ["Lines"]


class Lines(Located):
    """The lines of a file one after the other; errors name the last.

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
        self.source = path
        self.number = 0
        self._lines = read_lines(path)

    def next(self) -> str | None:
        """Return the next line; None after the last."""
        if self.number >= len(self._lines):
            return None
        self.number += 1
        return self._lines[self.number - 1]
