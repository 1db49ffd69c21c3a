"""Keyword blocks of an Abaqus input file: a keyword, its parameters and its data lines."""

import contextlib
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from fedic.io.mesh_formats._includes import Includes
from fedic.io.mesh_formats._numbers import real, shown
from fedic.io.mesh_formats.abaqus.lines import Line, split_items

__all__ = ["Block", "read_blocks"]

_PARAMETERS = {
    "NODE": ("INPUT", "NSET", "SYSTEM"),
    "NGEN": ("LINE", "NSET", "SYSTEM", "INPUT"),
    "NFILL": ("BIAS", "NSET", "SINGULAR", "TWOSTEP", "INPUT"),
    "NCOPY": ("CHANGENUMBER", "OLDSET", "NEWSET", "SHIFT", "REFLECT", "POLE", "MULTIPLE", "INPUT"),
    "NMAP": ("NSET", "TYPE", "DEFINITION", "INPUT"),
    "NSET": ("NSET", "ELSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED", "INPUT"),
    "ELEMENT": ("TYPE", "ELSET", "FILE", "INPUT", "OFFSET", "SOLIDELEMENTNUMBERING"),
    "ELGEN": ("ELSET", "ALLNODES", "INPUT"),
    "ELCOPY": ("ELEMENTSHIFT", "OLDSET", "NEWSET", "SHIFTNODES", "REFLECT", "INPUT"),
    "ELSET": ("ELSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED", "INPUT"),
    "INSTANCE": ("NAME", "PART", "INSTANCE", "LIBRARY"),
    "SYSTEM": (),
    "INCLUDE": ("INPUT", "PASSWORD"),
}
"""Parameters of the keywords that make the mesh, without blanks."""
_ORDER = ("PART", "ENDPART", "ASSEMBLY", "ENDASSEMBLY", "ENDINSTANCE", "RIGIDBODY")
_REFUSED = ("IMPERFECTION", "IMPORT", "SYMMETRICMODELGENERATION")
"""Keywords that change the mesh in a way that the input file does not hold."""
_WANTED = {*_PARAMETERS, *_ORDER, *_REFUSED, "PARAMETER", "SURFACE"}
_NO_PARAMETER = "*+-.,0123456789"
"""With what no continuation of a keyword line begins."""
_VALUE = re.compile(r"<([^<>]*)>")


@dataclass
class Block:
    """A keyword with its parameters, by name in capitals and without blanks, and the data lines that follow."""

    keyword: str
    parameters: dict[str, str]
    line: Line
    data: list[Line] = field(default_factory=list)


def read_blocks(path: Path) -> Iterator[Block]:
    """Yield the keyword blocks of a file that have to do with the mesh.

    ``*INCLUDE`` and ``INPUT=`` are followed, and values of ``*PARAMETER`` that are plain numbers are put in.

    Parameters
    ----------
    path : Path
        The main file.

    Yields
    ------
    Block
        Data lines only for the keywords that need them.

    Raises
    ------
    MeshError
        If a keyword or parameter is not known, or a file cannot be read.
    """
    files = Includes(path)
    values: dict[str, str] = {}
    block: Block | None = None
    for line in _lines(files, path, (path,)):
        if line.text.startswith("*"):
            if block is not None:
                yield from _finished(block, values)
            keyword, parameters = _split_keyword(line)
            if keyword in _REFUSED:
                raise line.error(
                    f"*{keyword} changes the mesh, which fedic does not follow; export the mesh that results."
                )
            block = Block(keyword, parameters, line) if keyword in _WANTED else None
            if block is not None and "INPUT" in parameters:
                block.data.extend(_with_values(each, values) for each in _input(files, block, path))
        elif block is not None:
            block.data.append(_with_values(line, values))
    if block is not None:
        yield from _finished(block, values)


def _finished(block: Block, values: dict[str, str]) -> Iterator[Block]:
    """Yield a block that is complete, or take over the values of ``*PARAMETER``."""
    if block.keyword != "PARAMETER":
        yield block
        return
    for line in block.data:
        name, _, value = (part.strip() for part in line.text.partition("="))
        with contextlib.suppress(ValueError):
            values[name.upper()] = str(real(value))


def _with_values(line: Line, values: dict[str, str]) -> Line:
    if "<" not in line.text:
        return line
    text = _VALUE.sub(lambda match: values.get(match[1].strip().upper(), match[0]), line.text)
    if "<" in text:
        raise line.error("a value depends on *PARAMETER, of which fedic knows plain numbers only; write the number.")
    return replace(line, text=text)


def _lines(files: Includes, path: Path, including: tuple[Path, ...]) -> Iterator[Line]:
    """Yield the lines of a file and of those it includes; the continuation of a keyword line is joined to it."""
    lines = _numbered(files, path)
    line = next(lines, None)
    while line is not None:
        following = next(lines, None)
        if line.text.startswith("*"):
            while line.text.endswith(",") and following is not None and following.text[0] not in _NO_PARAMETER:
                line = replace(line, text=line.text + following.text)
                following = next(lines, None)
        if _keyword(line) == "INCLUDE":
            _, parameters = _split_keyword(line)
            if "PASSWORD" in parameters:
                raise line.error("the included file is encrypted; include it as plain text.")
            if not parameters.get("INPUT"):
                raise line.error("*INCLUDE needs the name of a file: *INCLUDE, INPUT=name.")
            included = files.find(parameters["INPUT"], line.number, including)
            yield from _lines(files, included, (*including, included))
        else:
            yield line
        line = following


def _numbered(files: Includes, path: Path) -> Iterator[Line]:
    """Yield the lines of a file without blank lines and comments."""
    for number, raw in enumerate(files.read(path), start=1):
        text = raw.strip()
        if text and not text.startswith("**"):
            yield Line(path, number, text)


def _input(files: Includes, block: Block, path: Path) -> Iterator[Line]:
    included = files.find(block.parameters["INPUT"], block.line.number, tuple(dict.fromkeys((path, block.line.source))))
    for line in _lines(files, included, (path, included)):
        if line.text.startswith("*"):
            raise line.error(
                f"a file given by INPUT= holds data lines only; include it by *INCLUDE, not *{block.keyword}."
            )
        yield line


def _keyword(line: Line) -> str:
    """Return the keyword of a line in capitals and without blanks; empty for a data line."""
    return _compact(line.text[1:].partition(",")[0]) if line.text.startswith("*") else ""


def _split_keyword(line: Line) -> tuple[str, dict[str, str]]:
    keyword = _keyword(line)
    if keyword not in _WANTED:
        meant = [name for name in _WANTED if len(keyword) > 2 and name.startswith(keyword)]
        if meant:
            raise line.error(f"the keyword *{keyword} is abbreviated; write *{' or *'.join(sorted(meant))}.")
        return keyword, {}
    parameters = {}
    for item in split_items(line.text)[1:]:
        name, _, value = item.partition("=")
        name = _compact(name)
        known = _PARAMETERS.get(keyword)
        if not name:
            continue
        if known is not None and name not in known:
            full = [each for each in known if each.startswith(name)]
            if len(full) != 1:
                raise line.error(f"fedic does not know the parameter {shown(name)} of *{keyword}; remove it.")
            (name,) = full
        parameters[name] = value.strip().strip('"').strip()
    return keyword, parameters


def _compact(text: str) -> str:
    return "".join(text.split()).upper()
