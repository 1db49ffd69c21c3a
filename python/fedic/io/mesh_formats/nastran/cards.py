"""Bulk data of Nastran: cards in fields of 8 or 16 columns, or parted by commas."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from fedic.io.mesh_formats._includes import Includes
from fedic.io.mesh_formats._lines import Located, line_error
from fedic.io.mesh_formats._numbers import integer, label, real

__all__ = ["Card", "read_cards"]


_SMALL = range(8, 72, 8)
_LARGE = range(8, 72, 16)
"""First columns of the fields."""
_QUOTES = ("'", '"')
_LONGEST_NAME = 4096
"""Letters up to which the name of an included file goes on over several lines."""


@dataclass
class Card(Located):
    """One card: its name in capitals, the fields after the name, where it begins, and what is wrong with its lines."""

    name: str
    fields: list[str]
    source: Path
    number: int
    fault: str = ""

    def text(self, place: int) -> str:
        """Return a field; the first after the name is 1, and fields that are not there are blank.

        Parameters
        ----------
        place : int
            Number of the field.

        Returns
        -------
        str
            The field without blanks at its ends.
        """
        return self.fields[place - 1] if place <= len(self.fields) else ""

    def label(self, place: int) -> int:
        """Return the number of a node, element or property.

        Parameters
        ----------
        place : int
            Number of the field.

        Returns
        -------
        int
            A positive number.

        Raises
        ------
        MeshError
            If the field holds none.
        """
        return int(self._value(place, label))

    def integer(self, place: int, default: int) -> int:
        """Return a whole number.

        Parameters
        ----------
        place : int
            Number of the field.
        default : int
            The value of a blank field.

        Returns
        -------
        int
            The number.

        Raises
        ------
        MeshError
            If the field holds none.
        """
        return int(self._value(place, integer)) if self.text(place) else default

    def real(self, place: int) -> float:
        """Return a number; a blank field is zero.

        Parameters
        ----------
        place : int
            Number of the field.

        Returns
        -------
        float
            The number.

        Raises
        ------
        MeshError
            If the field holds none.
        """
        return float(self._value(place, real)) if self.text(place) else 0.0

    def _value(self, place: int, convert: Callable[[str], float]) -> float:
        if self.fault:
            raise self.error(self.fault)
        try:
            return convert(self.text(place))
        except ValueError as error:
            raise self.error(f"not a valid {self.name} card (field {place + 1}: {error}).") from error


def read_cards(path: Path) -> Iterator[Card]:
    """Yield the bulk data cards of a file and of those that it includes.

    What stands before ``BEGIN BULK`` and after ``ENDDATA`` is left out; a file without them is all bulk data.

    Parameters
    ----------
    path : Path
        The main file.

    Yields
    ------
    Card
        In the order of the file.

    Raises
    ------
    MeshError
        If a file cannot be read, or a continuation line belongs to no card.
    """
    lines = _bulk(_lines(Includes(path), path, (path,)))
    card: Card | None = None
    marks = {""}
    for source, number, line in lines:
        name, fields, large, end, fault = _fields(line)
        if not name or name[0] in "+*":
            if card is None:
                raise line_error(source, number, "this continuation line belongs to no card.")
            if name[1:].strip() and "" not in marks and name[1:].strip() not in marks:
                card.fault = "the lines of the card do not follow each other; write them in order."
            if not large and len(card.fields) % 8:
                card.fields += [""] * (8 - len(card.fields) % 8)
            card.fields += fields
            card.fault = card.fault or fault
        else:
            if card is not None:
                yield card
            card = Card(name.rstrip("*").strip(), fields, source, number, fault)
        marks = {end.lstrip("+* "), end[1:].strip()}  # the first column of a mark may hold any letter
    if card is not None:
        yield card


def _fields(line: str) -> tuple[str, list[str], bool, str, str]:
    """Return the name, the data fields, whether they have 16 columns, the mark of the continuation, and a fault."""
    fault = ""
    if "," in line:
        name, *items = [item.strip() for item in line.split(",")]
        large = name.endswith("*") or name.startswith("*")
        width = 4 if large else 8
        if len(items) > width + 1 and any(items[width + 1 :]):
            fault = f"more than {width + 2} fields in a line; continue the card on a new line."
        fields, end = items[:width], items[width] if len(items) > width else ""
        fields += [""] * (width - len(fields))
    else:
        if "\t" in line:
            line = line.expandtabs(8)
        name = line[:8].strip()
        large = name.endswith("*") or name.startswith("*")
        fields = [line[start : start + 16 if large else start + 8].strip() for start in (_LARGE if large else _SMALL)]
        end = line[72:80].strip()
    return name.upper(), fields, large, end.upper(), fault


def _bulk(lines: Iterator[tuple[Path, int, str]]) -> Iterator[tuple[Path, int, str]]:
    """Yield the lines of the bulk data."""
    kept = list(lines)
    starts = [index for index, (_, _, line) in enumerate(kept) if line.lstrip()[:6].upper().rstrip() == "BEGIN"]
    for index in starts:
        source, number, line = kept[index]
        words = line.upper().replace("=", " ").split()
        if words[1:2] == ["SUPER"] or words[2:] or index != starts[0]:
            raise line_error(source, number, "superelements and modules are not read; export one mesh for all of them.")
    for item in kept[starts[0] + 1 if starts else 0 :]:
        if item[2].lstrip()[:7].upper() == "ENDDATA":
            return
        yield item


def _lines(files: Includes, path: Path, including: tuple[Path, ...]) -> Iterator[tuple[Path, int, str]]:
    """Yield the lines of a file and of those it includes that are neither blank nor comments."""
    numbered = enumerate(files.read(path), start=1)
    for number, text in numbered:
        line = text.partition("$")[0].rstrip()
        if line[:1] in "Ii \t" and line.lstrip()[:7].upper() == "INCLUDE":
            name = line.lstrip()[7:].strip()
            while name[:1] in _QUOTES and name.count(name[:1]) == 1 and len(name) < _LONGEST_NAME:
                _, following = next(numbered, (0, name[0]))
                name += following.strip()
            included = files.find(name.strip("'\" \t"), number, including)
            yield from _lines(files, included, (*including, included))
        elif line:
            yield path, number, line
