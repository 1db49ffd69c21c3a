"""Rows and numbers of a table in text: its separator, its decimal point or comma."""

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fedic._internal.types import Floats

__all__ = ["Row", "TableError", "is_label", "numbers_of", "split_rows"]

_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?")
"""A number; also with a decimal comma."""
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity|n/?a)", re.IGNORECASE)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_WIDTHS = (4, 5)


class TableError(Exception):
    """What is wrong with a table, in words without a full stop."""


@dataclass(frozen=True)
class Row:
    """A line of a table.

    Attributes
    ----------
    line : int
        Its number in the file, from 1.
    fields : list of str
        Its columns, without blanks around them; decimal commas are points.
    """

    line: int
    fields: list[str]


def split_rows(text: str) -> list[Row]:
    """Split a text into the rows of its table, without comments and empty lines.

    Raises
    ------
    TableError
        If it is not clear what the commas in it mean.
    """
    text = text.replace("\r\n", "\n").replace("\r", "\n").replace("\u2212", "-").replace("\u00a0", " ")
    numbered = [(number, line.split("#")[0].strip(" ")) for number, line in enumerate(text.split("\n"), start=1)]
    lines = [
        (number, line) for number, line in numbered if line.strip("\t;, ") and not line.lstrip().startswith(("%", "//"))
    ]
    separator = next((each for each in ("\t", ";") if any(each in line for _, line in lines)), None)
    if separator is not None:
        rows = [Row(number, _fields(line, separator)) for number, line in lines]
        return _with_points(rows, certain=separator == ";")
    return _split_at_commas_or_blanks(lines)


def is_label(field: str) -> bool:
    """Return whether a field is not meant as a number."""
    return not _NUMBER.fullmatch(field) and not _NOT_FINITE.fullmatch(field)


def numbers_of(rows: Sequence[Row]) -> Floats:
    """Return the numbers of rows of equal length.

    Raises
    ------
    TableError
        If a field is not a finite number; its line is named.
    """
    for row in rows:
        for field in row.fields:
            if not _NUMBER.fullmatch(field) or not math.isfinite(float(field)):
                raise TableError(f"{field!r} in line {row.line} is not a finite number" if field else _empty(row))
    return np.array([[float(field) for field in row.fields] for row in rows])


def _empty(row: Row) -> str:
    return f"a column in line {row.line} is empty"


def _fields(line: str, separator: str) -> list[str]:
    """Split a line as spreadsheets write it, with quotes; empty fields at its end are left out."""
    try:
        (columns,) = csv.reader([line], delimiter=separator, skipinitialspace=True)
    except csv.Error as error:
        raise TableError(f"the line {line[:40]!r} is not of a table ({error})") from None
    fields = [field.strip() for field in columns]
    while fields and not fields[-1]:
        fields.pop()
    return fields


def _with_points(rows: list[Row], *, certain: bool) -> list[Row]:
    """Replace decimal commas by points.

    Parameters
    ----------
    rows : list of Row
        The rows.
    certain : bool
        True if a comma cannot separate thousands.
    """
    numbers = [(row, field) for row in rows for field in row.fields if _NUMBER.fullmatch(field)]
    commas = [entry for entry in numbers if "," in entry[1]]
    points = [entry for entry in numbers if "." in entry[1]]
    if commas and points:
        (row, comma), (other, point) = commas[0], points[0]
        raise TableError(
            f"{comma!r} in line {row.line} has a comma and {point!r} in line {other.line} a point; write all numbers "
            "with decimal points"
        )
    if commas and not certain and all(_THOUSANDS.fullmatch(field) for _, field in commas):
        row, comma = commas[0]
        raise TableError(
            f"the comma of {comma!r} in line {row.line} may separate thousands or decimals; write all numbers with "
            "decimal points"
        )
    return [
        Row(row.line, [field.replace(",", ".") if _NUMBER.fullmatch(field) else field for field in row.fields])
        for row in rows
    ]


def _split_at_commas_or_blanks(lines: list[tuple[int, str]]) -> list[Row]:
    """Split lines without tabs and semicolons, in which commas separate numbers or their decimals."""
    by_commas = [Row(number, _fields(line, ",")) for number, line in lines]
    if any('"' in line for _, line in lines):
        return _with_points(by_commas, certain=False)
    by_blanks = [Row(number, line.split()) for number, line in lines]
    by_both = [Row(number, re.sub(r"\s*,\s*|\s+", ",", line).strip(",").split(",")) for number, line in lines]
    if not any(re.search(r"\d,\d", line) and re.search(r"[\d.]\s+[-+.\d]", line) for _, line in lines):
        return by_commas if lines and len(by_commas[-1].fields) >= min(_WIDTHS) else by_both
    decimal, separate = (_width(rows) in _WIDTHS for rows in (by_blanks, by_both))
    if decimal and separate:
        number, line = next((number, line) for number, line in lines if re.search(r"\d,\d", line))
        raise TableError(
            f"the commas in line {number}, {line!r}, may separate numbers or decimals; write decimal points, and one "
            "separator"
        )
    return _with_points(by_blanks, certain=True) if decimal else by_both


def _width(rows: list[Row]) -> int:
    """Return the number of columns of the last row, which is no heading; 0 if it has others than numbers."""
    return len(rows[-1].fields) if rows and not any(map(is_label, rows[-1].fields)) else 0
