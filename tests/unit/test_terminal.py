"""Names of files on the terminal: shown, and doing nothing else."""

import subprocess
import sys
import unicodedata
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fedic.cli.common import reported_errors
from fedic.cli.terminal import print_table, shown
from fedic.errors import FedicError


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("plain é 図 [red].tif", "plain é 図 [red].tif"),
        ("a\x1b[31mb", r"a\x1b[31mb"),
        ("a\nb\r\tc\x00\x7f", r"a\nb\r\tc\x00\x7f"),
        ("\u202etxt.exe", r"\u202etxt.exe"),
        ("\udcff", r"\udcff"),
        ("\u2028", r"\u2028"),
    ],
)
def test_characters_that_steer_the_terminal_are_escaped(name: str, text: str) -> None:
    assert shown(name) == text


@given(st.text(st.characters(exclude_categories=())))
def test_what_is_shown_has_one_line_and_can_be_printed(text: str) -> None:
    assert not {unicodedata.category(character) for character in shown(text)} & {"Cc", "Cf", "Cs", "Zl", "Zp"}
    assert len(shown(text).splitlines()) <= 1
    shown(text).encode("utf-8")


def test_tables_have_no_markup(capsys: pytest.CaptureFixture[str]) -> None:
    print_table("[bold]title", ("view", "[x]"), [("im[red]4.tif", ":smile:"), ("a\x1b[31mb", "1")], left=("view",))
    printed = capsys.readouterr().out
    for text in ("[bold]title", "[x]", "im[red]4.tif", ":smile:", r"a\x1b[31mb"):
        assert text in printed
    assert "\x1b" not in printed


def test_errors_are_escaped_but_keep_their_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(Exception, match="2"), reported_errors():
        raise FedicError("\x1b[2J.tif: first\nsecond")
    assert capsys.readouterr().err == "fedic: \\x1b[2J.tif: first\nsecond\n"


def test_letters_that_the_terminal_lacks_are_escaped() -> None:
    code = f"import sys; sys.path.insert(0, {str(Path(__file__).parents[2] / 'python')!r})\n"
    code += "from fedic.cli.terminal import echo\necho('é图.tif')"
    outcome = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, env={"PYTHONIOENCODING": "ascii"}, check=True
    )
    assert outcome.stdout == b"\\xe9\\u56fe.tif\n"
