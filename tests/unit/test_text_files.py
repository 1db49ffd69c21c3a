"""Text of files in any encoding, and files that are not read at all."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import fedic
from fedic.io.files import read_bytes, read_start
from fedic.io.text import decoded, read_text

MARKED = ("utf-8", "utf-16-le", "utf-16-be", "utf-32-le", "utf-32-be")
LATIN = st.text(st.characters(min_codepoint=1, max_codepoint=255), min_size=1)


@given(st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0")), st.sampled_from(MARKED))
def test_the_byte_order_mark_tells_the_encoding(text: str, encoding: str) -> None:
    assert decoded(f"\ufeff{text}".encode(encoding)) == text


@given(LATIN, st.sampled_from(["utf-8", "utf-16-le", "utf-16-be"]))
def test_western_text_without_a_mark_is_read(text: str, encoding: str) -> None:
    assert decoded(text.encode(encoding)) == text


@given(st.text(st.characters(min_codepoint=0x3041, max_codepoint=0x3096), max_size=400))
def test_a_comment_in_japanese_does_not_hide_utf_16(comment: str) -> None:
    text = "*HEADING\n" + comment + "\n*NODE\n" + "1, 0.0, 0.0\n" * 40
    assert decoded(text.encode("utf-16-le")) == text


@given(st.binary())
def test_any_bytes_are_decoded_where_faults_are_replaced(content: bytes) -> None:
    assert isinstance(decoded(content, "replace"), str)


def test_binary_numbers_are_not_taken_for_text(tmp_path: Path) -> None:
    path = tmp_path / "numbers.txt"
    path.write_bytes(bytes([1, 0, 0, 0]) * 100)
    with pytest.raises(fedic.FedicError, match=r"numbers\.txt: the file cannot be read as text: it holds zero bytes"):
        read_text(path, 1000)


def test_what_is_no_regular_file_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for name, message in (
        ("pipe", "pipe: this is a device or a pipe; save what it holds in a file"),
        (".", "this is a folder; give the name of a file"),
        ("none", "none: there is no such camera file; check the path"),
        ("x" * 300, "the camera file cannot be read .*too long"),
        ("a\0b", "the camera file cannot be read .*null"),
    ):
        for limit in (0, 100):
            with pytest.raises(fedic.CameraError, match=message):
                read_bytes(tmp_path / name, limit, fedic.CameraError, "camera file")
            with pytest.raises(fedic.CameraError, match=message):
                read_start(tmp_path / name, limit, fedic.CameraError, "camera file")


def test_a_file_that_is_too_large_is_refused(tmp_path: Path) -> None:
    large = tmp_path / "large.txt"
    large.write_text("x" * 101)
    with pytest.raises(fedic.MeshError, match=r"101 bytes; one of this kind has at most 100"):
        read_text(large, 100, fedic.MeshError)
    assert read_text(large, 101) == "x" * 101
    assert read_start(large, 3) == b"xxx"
