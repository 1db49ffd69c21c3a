"""Datasets of a universal file: lines between two marks ``-1``."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from fedic.errors import MeshError
from fedic.io.mesh_formats._lines import line_error, read_lines
from fedic.io.mesh_formats._numbers import integer, real

__all__ = ["Dataset", "read_datasets"]

_MARK = "-1"


@dataclass
class Dataset:
    """A dataset: its number, its lines, and where they begin in the file."""

    number: int
    lines: list[str]
    source: Path
    first: int

    def error(self, index: int, message: str) -> MeshError:
        """Return the error to raise for a line.

        Parameters
        ----------
        index : int
            The line, counted in the dataset.
        message : str
            What is wrong and what to do.

        Returns
        -------
        MeshError
            With the file and the line number.
        """
        return line_error(self.source, self.first + index, message)

    def integers(self, index: int) -> list[int]:
        """Return the whole numbers of a line.

        Parameters
        ----------
        index : int
            The line, counted in the dataset.

        Returns
        -------
        list of int
            The numbers.

        Raises
        ------
        MeshError
            If the line is missing, or holds something else.
        """
        return [int(value) for value in self._values(index, integer)]

    def reals(self, index: int) -> list[float]:
        """Return the numbers of a line.

        Parameters
        ----------
        index : int
            The line, counted in the dataset.

        Returns
        -------
        list of float
            The numbers.

        Raises
        ------
        MeshError
            If the line is missing, or holds something else.
        """
        return self._values(index, real)

    def _values(self, index: int, convert: Callable[[str], float]) -> list[float]:
        if index >= len(self.lines):
            raise self.error(index, f"the dataset {self.number} ends in the middle of an entry; the file is damaged.")
        try:
            return [convert(item) for item in self.lines[index].split()]
        except ValueError as error:
            raise self.error(index, f"not a valid line of the dataset {self.number} ({error}).") from error


def read_datasets(path: Path) -> Iterator[Dataset]:
    """Yield the datasets of a file.

    Parameters
    ----------
    path : Path
        The file.

    Yields
    ------
    Dataset
        In the order of the file.

    Raises
    ------
    MeshError
        If the file cannot be read, or a dataset has no number or no end.
    """
    lines = read_lines(path)
    marks = [index for index, line in enumerate(lines) if line.strip() == _MARK]
    if not marks:
        raise MeshError(f"{path}: this is no universal file; it has no line -1 that begins a dataset.")
    inside = False
    for begin, end in zip(marks, [*marks[1:], len(lines)], strict=True):
        inside = not inside
        if not inside:
            continue
        if end == len(lines):
            raise line_error(path, begin + 1, "the dataset that begins here has no end; the file is damaged.")
        head = lines[begin + 1].split()
        if not head or not head[0].rstrip("bB").isdigit():
            raise line_error(path, begin + 2, "the number of the dataset is missing; the file is damaged.")
        yield Dataset(int(head[0].rstrip("bB")), lines[begin + 2 : end], path, begin + 3)
