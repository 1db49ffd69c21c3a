"""Point pairs in text files, as people and spreadsheets write them."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fedic._internal.types import Floats, StrPath
from fedic.errors import CameraError
from fedic.io.text import decoded
from fedic.registration._pair_rows import Row, TableError, is_label, numbers_of, split_rows

__all__ = ["read_pairs"]

_MOST_BYTES = 2**24
_NAMES = {"x": "X", "y": "Y", "z": "Z", "u": "u", "v": "v"}
_FEWEST_COUNTED = 3
_REMEDY = "write X Y u v or X Y Z u v on each line, or a heading with these names"


def read_pairs(path: StrPath) -> tuple[Floats, Floats]:
    """Read point pairs from a text file, such as one that a spreadsheet wrote.

    Parameters
    ----------
    path : str or path
        File with one pair per line: X, Y, u, v or X, Y, Z, u, v, separated by tabs, semicolons, commas or blanks.
        Decimal commas are read where commas do not separate; ``#`` begins a comment. A heading with these names may
        give another order and further columns, which are ignored; without a heading, a column of labels, or of numbers
        of the lines before X, Y, Z, u, v, is ignored. UTF-8 or UTF-16.

    Returns
    -------
    points : ndarray, shape (m, 2) or (m, 3)
    pixels : ndarray, shape (m, 2)

    Raises
    ------
    CameraError
        If the file is missing, has another content, or can be read in two ways.
    """
    try:
        rows = split_rows(_text(Path(path)))
        names, rows = _without_heading(rows)
        table = _named(names, rows) if names else _unnamed(rows)
    except TableError as fault:
        raise CameraError(f"{path}: the point pairs cannot be read: {fault}.") from None
    return table[:, :-2], table[:, -2:]


def _text(path: Path) -> str:
    try:
        if path.exists() and not path.is_file():
            raise TableError("this is not a regular file")
        if path.stat().st_size > _MOST_BYTES:
            raise TableError(f"the file has over {_MOST_BYTES >> 20} MB; is it another one?")
        data = path.read_bytes()
    except OSError as fault:
        raise TableError(fault.strerror or str(fault)) from None
    # Only comments, headings and labels have letters, which do not matter.
    return decoded(data, "replace")


@dataclass(frozen=True)
class _Heading:
    """The places of the columns of a table: X, Y, perhaps Z, u, v."""

    places: list[int]
    width: int


def _without_heading(rows: list[Row]) -> tuple[_Heading | None, list[Row]]:
    """Return the heading, if there is one, and the rows below; titles and units are skipped."""
    heading: _Heading | None = None
    unnamed: Row | None = None
    for index, row in enumerate(rows):
        if not all(is_label(field) for field in row.fields):
            if heading is None and unnamed is not None:
                raise TableError(
                    f"the heading in line {unnamed.line} does not name each of X, Y, u and v once; {_REMEDY}"
                )
            return heading, rows[index:]
        heading = heading or _heading(row)
        if sum(field != "" for field in row.fields) > 3:
            unnamed = unnamed or row
    raise TableError(f"there is no line with numbers; {_REMEDY}")


def _heading(row: Row) -> _Heading | None:
    fields = row.fields if len(row.fields) > 3 else re.split(r"[\s,;]+", " ".join(row.fields))
    words = [re.split(r"[\s,(\[/]+", field) for field in fields]
    names = [_NAMES.get(word[0].lower()) for word in words]
    if any(names.count(name) > 1 for name in _NAMES.values()) or not {"X", "Y", "u", "v"} <= {*names}:
        return None
    return _Heading([names.index(name) for name in _NAMES.values() if name in names], len(names))


def _named(heading: _Heading, rows: Sequence[Row]) -> Floats:
    for row in rows:
        if len(row.fields) != heading.width:
            raise TableError(f"line {row.line} has {len(row.fields)} columns and the heading {heading.width}")
    return numbers_of([Row(row.line, [row.fields[place] for place in heading.places]) for row in rows])


def _unnamed(rows: Sequence[Row]) -> Floats:
    width = len(rows[0].fields)
    for row in rows:
        if len(row.fields) != width:
            raise TableError(
                f"line {row.line} has {len(row.fields)} columns and line {rows[0].line} has {width}; {_REMEDY}"
            )
    if width in (5, 6) and all(is_label(row.fields[0]) and row.fields[0] for row in rows):
        rows = [Row(row.line, row.fields[1:]) for row in rows]
        width -= 1
    table = numbers_of(rows)
    counted = len(rows) >= _FEWEST_COUNTED and any(
        (table[:, 0] == np.arange(len(rows)) + first).all() for first in (0, 1)
    )
    if width == 6 and counted:
        return table[:, 1:]
    if width == 5 and counted:
        raise TableError(
            "the first of five columns counts the lines, so that it may be a number or X; leave it out, or write a "
            "heading such as X Y Z u v or number X Y u v"
        )
    if width not in (4, 5):
        raise TableError(f"{width} numbers on a line; {_REMEDY}")
    return table
