"""Tables in text files of testing machines: separators, decimal commas, lines of names and units."""

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fedic.errors import FedicError
from fedic.io.text import read_text

__all__ = ["TextTable", "name_and_unit", "number", "read_text_table"]

_LIMIT = 1 << 30
"""Largest size of a file, in bytes."""
_SEPARATORS = ("\t", ";", ",")
_LONGEST_HEADING = 200
"""Longest heading in which a unit is looked for."""
_SAMPLE = 200
"""Number of lines from which the separator is found."""
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)*|[.,]\d+)([eE][+-]?\d+)?")
_NUMERALS = dict.fromkeys(map(ord, "0123456789+-.,eE"))
_MOMENT = re.compile(r"(\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}[ T]+)?\d{1,4}:\d{2}(:\d{2}([.,]\d+)?)?( ?[AaPp][Mm])?Z?")
_MISSING = re.compile(r"|-+|nan|n/?a|null|[+-]?inf(inity)?|#\S*|\*+", re.IGNORECASE)
_UNIT = re.compile(
    r"[\[(].*[\])]|-?|%|[a-zµμ°²³0-9/^*·.-]{1,4}|[munpµμkMG]?[A-Za-z]{1,2}\^?[²³23]?([/*·][a-zA-Z]{1,4}\^?[²³23]?)?|"
    r"(sec|sek|min|msec|cycles|segments|strain|deg|mstrain|kgf|lbf|psi|ksi|volts?|degc)\.?",
    re.IGNORECASE,
)
_NAME_AND_UNIT = re.compile(r"(?P<name>.*?\S)\s*(?:[\[(](?P<bracket>[^\[\]()]*)[\])]|/\s*(?P<slash>[^/\s]+))")


@dataclass(frozen=True)
class TextTable:
    """A table of a text file.

    Attributes
    ----------
    path : Path
        The file.
    names, units : list of str
        Name and unit of each column; the unit is empty if the file has none.
    rows : list of list of str
        The fields of each row, without blanks around them.
    lines : list of int
        Number of the line of each row, from 1.
    """

    path: Path
    names: list[str]
    units: list[str]
    rows: list[list[str]]
    lines: list[int]


def number(text: str) -> float:
    """Return the number in a field, with a decimal point or comma.

    Parameters
    ----------
    text : str
        The field. If it has both marks, the last is the decimal one, and the others separate thousands, as do several
        marks of one kind.

    Returns
    -------
    float
        NaN if it holds no finite number.
    """
    try:  # most numbers are of this kind
        found = float(text.replace(",", "."))
    except ValueError:
        found = math.nan
    if math.isfinite(found) and "_" not in text:
        return found
    if not _NUMBER.fullmatch(text):
        return math.nan
    decimal = max(text.rfind("."), text.rfind(","))
    if decimal >= 0 and text.count(text[decimal]) > 1:
        text = re.sub("[.,]", "", text)
    elif decimal >= 0:
        text = re.sub("[.,]", "", text[:decimal]) + "." + text[decimal + 1 :]
    found = float(text)
    return found if math.isfinite(found) else math.nan


def name_and_unit(text: str) -> tuple[str, str]:
    """Split the heading of a column.

    Parameters
    ----------
    text : str
        Such as ``"Load (kN)"``, ``"Load [kN]"`` or ``"Load / kN"``.

    Returns
    -------
    name, unit : str
        The unit is empty if there is none.
    """
    text = text.strip()
    found = _NAME_AND_UNIT.fullmatch(text) if len(text) <= _LONGEST_HEADING else None
    if found is None:
        return text, ""
    return found["name"].rstrip(" ,_"), (found["bracket"] or found["slash"] or "").strip()


def read_text_table(path: Path) -> TextTable:
    """Read the table of a text file.

    The table is the longest run of lines with numbers that are equally long. The line above it holds the names, or the
    units if it looks like units, and then the next one above holds the names.

    Parameters
    ----------
    path : Path
        The file; its separator is a tab, a semicolon or a comma.

    Returns
    -------
    TextTable
        The table.

    Raises
    ------
    FedicError
        If the file cannot be read, or holds no table, several, no names, or a row of another length.
    """
    lines = [line.strip(" ") for line in read_text(path, _LIMIT, FedicError, "table of the machine").splitlines()]
    separator = _separator(lines)
    fields = [_fields(line, separator) for line in lines]
    is_data = [_is_data(each) for each in fields]
    start, stop = _longest_run(fields, is_data)
    if start == stop:
        raise FedicError(
            f"{path}: the file holds no table: no line has two columns of numbers separated by tabs, semicolons or "
            "commas."
        )
    width = len(fields[start])
    for index in range(stop, len(fields)):
        if is_data[index]:
            raise FedicError(
                f"{path}: line {index + 1} has {len(fields[index])} fields, and the table that ends in line {stop} has "
                f"{width}, or other text lies between them; leave one table in the file, with rows of one length."
            )
    names, units = _heading(path, fields[:start], width)
    kept = [index for index in range(start, stop) if any(fields[index])]
    _check_decimals(path, fields, kept)
    filled = [column for column in range(width) if names[column]]
    return TextTable(
        path,
        [names[column] for column in filled],
        [units[column] for column in filled],
        [[fields[index][column] for column in filled] for index in kept],
        [index + 1 for index in kept],
    )


def _separator(lines: Sequence[str]) -> str:
    """Return the separator that makes the most fields of the lines after the middle numbers, and the fewest text."""
    filled = [line for line in lines if line]
    middle = len(filled) // 2
    sample = filled[middle : middle + _SAMPLE]

    def score(separator: str) -> float:
        rows = [fields for line in sample if len(fields := _fields(line, separator)) > 1]
        return sum(2 * _known(row) - _filled(row) for row in rows) if rows else -math.inf

    return max(_SEPARATORS, key=score)


def _fields(line: str, separator: str) -> list[str]:
    if '"' in line and len(line) < csv.field_size_limit():
        return [field.strip() for field in next(csv.reader([line], delimiter=separator), [])]
    return [field.strip() for field in line.split(separator)] if line else []


def _is_data(fields: Sequence[str]) -> bool:
    """Return whether at least half of the fields are numbers or moments, and the rest is missing or text."""
    if not "".join(fields).translate(_NUMERALS):  # most rows are of this kind
        return any(map(str.isdecimal, "".join(fields)))
    known = _known(fields)
    return known > 0 and 2 * known >= _filled(fields)


def _known(fields: Sequence[str]) -> int:
    return sum(bool(_NUMBER.fullmatch(field) or _MOMENT.fullmatch(field)) for field in fields)


def _filled(fields: Sequence[str]) -> int:
    return sum(not _MISSING.fullmatch(field) for field in fields)


def _longest_run(fields: Sequence[list[str]], is_data: Sequence[bool]) -> tuple[int, int]:
    """Return the first line and the line after the last one of the longest table; empty lines do not end it."""
    best, start, last = (0, 0), -1, -1
    for index, row in enumerate(fields):
        if is_data[index] and len(row) > 1:
            if start < 0 or len(row) != len(fields[start]):
                start = index
            last = index
            if last + 1 - start > best[1] - best[0]:
                best = (start, last + 1)
        elif any(row) and not (start >= 0 and len(row) == len(fields[start]) and not _filled(row)):
            start = -1
    return best


def _heading(path: Path, above: Sequence[list[str]], width: int) -> tuple[list[str], list[str]]:
    """Return the names and units of the columns."""
    rows = [row + [""] * (width - len(row)) for row in above if any(row) and width - 1 <= len(row) <= width]
    rows = [row for row in rows if not _is_data(row)][-2:]
    if not rows:
        raise FedicError(f"{path}: no line above the table names its {width} columns; add one.")
    if len(rows) == 2 and all(_UNIT.fullmatch(field) for field in rows[1]) and any(rows[1]):
        names = rows[0]
        units = [field.strip("[]() ") for field in rows[1]]
    else:
        names, units = map(list, zip(*(name_and_unit(field) for field in rows[-1]), strict=True))
        twice = {name for name in names if names.count(name) > 1}
        names = [full if name in twice else name for full, name in zip(rows[-1], names, strict=True)]
    for name in names:
        if name and names.count(name) > 1:
            raise FedicError(f"{path}: two columns are named {name!r}; give each a name of its own.")
    return names, units


def _check_decimals(path: Path, fields: Sequence[list[str]], lines: Sequence[int]) -> None:
    """Refuse tables in which some numbers have one point and others one comma."""
    first: dict[str, int] = {}
    for index in lines:
        for field in fields[index]:
            for mark in ".,":
                if mark not in first and field.count(mark) == 1 and _NUMBER.fullmatch(field):
                    other = "," if mark == "." else "."
                    if other not in field:
                        first[mark] = index + 1
        if len(first) == 2:
            raise FedicError(
                f"{path}: line {first['.']} has numbers with a decimal point and line {first[',']} with a decimal "
                "comma; write all of them alike."
            )
