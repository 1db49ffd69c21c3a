"""Blocks of numbers in columns: ``NBLOCK``, ``EBLOCK``, ``CMBLOCK`` and ``ETBLOCK``."""

import re
from collections.abc import Iterator

from fedic.io.mesh_formats._numbers import integer, label, real
from fedic.io.mesh_formats.ansys.lines import Lines

__all__ = ["read_element_block", "read_integers", "read_node_block"]

_MOST_COLUMNS = 200
_FORMAT = re.compile(r"\(\s*(\d*)i(\d+)\s*(?:,\s*(\d*)[a-z](\d+)(?:\.\d+(?:e\d+)?)?)?[^)]*\)", re.IGNORECASE)


def read_node_block(lines: Lines) -> Iterator[tuple[int, tuple[float, float, float]]]:
    """Yield the nodes of an ``NBLOCK``.

    Parameters
    ----------
    lines : Lines
        The lines after the command.

    Yields
    ------
    label : int
        Number of the node.
    point : tuple of float
        Its coordinates; those that are left out at the end of a line are zero.

    Raises
    ------
    MeshError
        If a line cannot be understood.
    """
    match = _format(lines)
    if match[4] is None:
        raise lines.error("the format of the block has no columns for coordinates.")
    count, width, size = int(match[1] or 1), int(match[2]), int(match[4])
    widths = [width] * count + [size] * 3
    for line in _until_end(lines):
        fields = [*_fields(line, widths), "", "", ""]
        with lines.reported("NBLOCK"):
            x, y, z = (real(field) if field else 0.0 for field in fields[count : count + 3])
            number, *_ = label(fields[0]), *(integer(field) for field in fields[1:count] if field)
        yield number, (x, y, z)


def read_element_block(lines: Lines, solid: bool) -> Iterator[tuple[int, int, list[int]]]:
    """Yield the elements of an ``EBLOCK``.

    Parameters
    ----------
    lines : Lines
        The lines after the command.
    solid : bool
        True for ``EBLOCK,19,SOLID``, whose lines begin with eleven numbers; otherwise with five.

    Yields
    ------
    label : int
        Number of the element.
    kind : int
        Number of its type in the file.
    nodes : list of int
        Numbers of its nodes.

    Raises
    ------
    MeshError
        If a line cannot be understood.
    """
    width = int(_format(lines)[2])
    for line in _until_end(lines):
        numbers = _integers(lines, line, width, "EBLOCK")
        head = 11 if solid else 5
        if len(numbers) <= head:
            raise lines.error(f"an element of EBLOCK begins with {head} numbers and its nodes; the file is damaged.")
        element, kind, nodes = numbers[10 if solid else 0], numbers[1], numbers[head:]
        while solid and len(nodes) < numbers[8]:
            more = lines.next()
            if more is None:
                raise lines.error(f"element {element} ends before its {numbers[8]} nodes; the file is damaged.")
            nodes += _integers(lines, more, width, "EBLOCK")
        yield element, kind, nodes[: numbers[8]] if solid else nodes


def read_integers(lines: Lines, name: str, count: int | None = None) -> Iterator[list[int]]:
    """Yield the whole numbers of the lines of a block.

    Parameters
    ----------
    lines : Lines
        The lines after the command.
    name : str
        The command.
    count : int or None
        How many numbers there are; None if the block ends with ``-1``.

    Yields
    ------
    list of int
        The numbers of one line.

    Raises
    ------
    MeshError
        If a line cannot be understood, or the block ends too early.
    """
    match = _format(lines)
    if count is None:
        for line in _until_end(lines):
            yield _integers(lines, line, int(match[2]), name, int(match[1] or 1))
        return
    while count > 0:
        line_ = lines.next()
        numbers = _integers(lines, line_ or "", int(match[2]), name)
        if not numbers:
            raise lines.error(f"the {name} block ends before its last number; the file is damaged.")
        count -= len(numbers)
        yield numbers


def _format(lines: Lines) -> re.Match[str]:
    line = lines.next()
    match = _FORMAT.match(line.strip()) if line is not None else None
    if match is None or any(number and not 0 < int(number[:4]) <= _MOST_COLUMNS for number in match.groups()):
        raise lines.error("the format of the block, (19i9) for instance, is missing or is not known.")
    return match


def _until_end(lines: Lines) -> Iterator[str]:
    """Yield the lines of a block up to ``-1``, or to a command such as ``N,R5.3,LOC,-1``."""
    while True:
        line = lines.next()
        if line is None:
            raise lines.error("the block has no end; the file is damaged.")
        if line.strip() == "-1" or line.strip()[:2].upper() == "N,":
            return
        yield line


def _integers(lines: Lines, line: str, width: int, name: str, most: int | None = None) -> list[int]:
    line = line.rstrip()
    count = -(-len(line) // width)
    with lines.reported(name):
        fields = _fields(line, [width] * (count if most is None else min(count, most)))
        return [integer(field) if field else 0 for field in fields]


def _fields(line: str, widths: list[int]) -> list[str]:
    """Return the fields of a line by columns, or by blanks if a column would cut a number.

    A number may touch the next one only where the next one has a sign, or where it is whole and fills its column.
    """
    fields = []
    start = 0
    for width in widths:
        field, following = line[start : start + width], line[start + width : start + width + 1]
        whole = len(field) == width and field.lstrip("-").isdigit()
        if field[-1:].strip() and following.strip(" \t+-") and not whole:
            return line.split()
        fields.append(field.strip())
        start += width
    return fields
