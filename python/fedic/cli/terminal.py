"""Text on the terminal: what comes from files and their names is shown as it is, and does nothing else."""

import sys
import unicodedata
from collections.abc import Iterable, Sequence

import typer

__all__ = ["echo", "print_table", "shown"]

_HIDDEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Unicode categories without a shape of their own: control and format characters, undecoded bytes, line separators."""


def shown(text: str) -> str:
    r"""Escape the characters of a name that would steer the terminal, or that it cannot show.

    Parameters
    ----------
    text : str
        Such as the name of a file.

    Returns
    -------
    str
        One line, with ``\\n``, ``\\x1b`` or ``\\udcff`` for a newline, an escape character or an undecoded byte.
    """
    return "".join(_escaped(each) if unicodedata.category(each) in _HIDDEN else each for each in text)


def echo(text: str, *, err: bool = False) -> None:
    """Print lines, escaped as by `shown` but for the newlines between them.

    Parameters
    ----------
    text : str
        The lines.
    err : bool
        If true, print on stderr.
    """
    lines = "\n".join(map(shown, text.split("\n")))
    encoding = getattr(sys.stderr if err else sys.stdout, "encoding", None) or "utf-8"
    typer.echo(lines.encode(encoding, "backslashreplace").decode(encoding), err=err)


def print_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]], *, left: Sequence[str] = ()) -> None:
    """Print a table whose cells are plain text, without markup.

    Parameters
    ----------
    title : str
        Title.
    columns : sequence of str
        Headings; the columns are aligned to the right.
    rows : iterable of sequence of str
        Cells.
    left : sequence of str
        Headings of the columns that are aligned to the left and wrap.
    """
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(shown(title)))
    for column in columns:
        if column in left:
            table.add_column(Text(column), overflow="fold")
        else:
            table.add_column(Text(column), justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*(Text(shown(cell)) for cell in row))
    Console().print(table)


def _escaped(character: str) -> str:
    return character.encode("unicode_escape", "surrogatepass").decode("ascii")
