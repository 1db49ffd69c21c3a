"""Abaqus input files: keyword lines, numbers, encodings, included files."""

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fedic
from fedic.io.mesh_formats import _includes
from fedic.io.mesh_formats._numbers import real

NODES = "1, 0., 0., 0.\n2, 10., 0., 0.\n3, 10., 10., 0.\n4, 0., 10., 0.\n5, 20., 0., 0.\n6, 20., 10., 0.\n"
ELEMENTS = "1, 1, 2, 3, 4\n2, 2, 5, 6, 3\n"
DECK = f"*NODE\n{NODES}*ELEMENT, TYPE=CPS4, ELSET=ALL\n{ELEMENTS}"


def assert_two_cells(path: Path) -> fedic.Mesh:
    mesh = fedic.read_mesh(path)
    np.testing.assert_array_equal(mesh.points, [[0, 0], [10, 0], [10, 10], [0, 10], [20, 0], [20, 10]])
    np.testing.assert_array_equal(mesh.cells["quad"], [[0, 1, 2, 3], [1, 4, 5, 2]])
    return mesh


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("*NODE", "*Node , "),
        ("*NODE", " * n o d e"),
        ("TYPE=CPS4, ELSET=ALL", "TYPE=CPS4,\n ELSET=ALL"),
        ("TYPE=CPS4, ELSET=ALL", "TYPE=CPS4,\n** a comment\n\n ELSET=ALL"),
        ("TYPE=CPS4, ELSET=ALL", 'Elset="ALL" ,  type = cps4r'),
        ("TYPE=CPS4, ELSET=ALL", "TYP=CPS4, ELS=ALL"),
        ("1, 1, 2, 3, 4", "1, 1, 2,\n3, 4"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3, 4,"),
        ("3, 10., 10., 0.", "3, 1.0D+01, 1.d1"),
        ("3, 10., 10., 0.", "3, 1.+1, +100.-1,"),
        ("3, 10., 10., 0.", "\t3 ,\t10 , 1E1"),
        ("3, 10., 10., 0.", "3, 10., 10., 0., 0., 0., 1."),
        ("4, 0., 10., 0.", "4, , 10."),
        ("1, 0., 0., 0.", "1"),
        ("*NODE", "*TRANSFORM, NSET=ALL, TYPE=C\n0,0,0,0,0,1\n*NODE"),
        ("3, 10., 10., 0.", "3, 7., 7.\n3, 10., 10., 0."),
        ("2, 2, 5, 6, 3", "2, 2, 5, 6, 1\n2, 2, 5, 6, 3"),
        ("2, 2, 5, 6, 3", "2, 2, 5, 6, 3\n3, 5, 6, 3, 2\n4, 2, 5, 6, 3"),
        ("3, 10., 10., 0.", "3, <side>, <side>"),
        ("\n", "\r\n"),
        ("\n", "\r"),
        ("2, 2, 5, 6, 3\n", "2, 2, 5, 6, 3\n\x1a"),
    ],
)
def test_what_abaqus_reads_is_read(tmp_path: Path, old: str, new: str) -> None:
    path = tmp_path / "plate.inp"
    path.write_bytes(f"*PARAMETER\nside = 10.\n{DECK}".replace(old, new).encode())
    mesh = assert_two_cells(path)
    assert mesh.sets["ALL"].cells.tolist() == [0, 1]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
def test_encodings_are_told_by_the_bytes(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "plate.inp"
    path.write_bytes(f"{DECK}** \xe9prouvette\x85\n*ELSET, ELSET=\xe9l\xe9ment\n2\n".encode(encoding))
    mesh = assert_two_cells(path)
    assert mesh.sets["\xe9l\xe9ment"].cells.tolist() == [1]


def test_a_binary_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "plate.inp").write_bytes(b"ODB\1\2\3\0\0\7\0\0\0")
    with pytest.raises(fedic.MeshError, match="this is a binary file"):
        fedic.read_mesh(tmp_path / "plate.inp")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("1, 1, 2, 3, 4", "1, 1, 2, 3", r"line 9: element 1 has 3 nodes; CPS4 has 4"),
        ("2, 2, 5, 6, 3", "2, 2, 5, 6", r"line 10: element 2 has 3 nodes; CPS4 has 4"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3, 4, 2, 2, 5, 6, 3", r"line 9: element 1 has 9 nodes; CPS4 has 4"),
        ("1, 1, 2, 3, 4", "1, 1, , 3, 4", r"line 9: not a valid line of \*ELEMENT \('' is not a whole number"),
        ("3, 10.", "3, 1_0.", "line 4: not a valid line of .NODE .'1_0.' is not a number"),
        ("3, 10.", "3, nan", "'nan' is not a number"),
        ("3, 10.", "3, 1e999", "'1e999' is too large a number"),
        ("3, 10.", "3, <width>", r"line 4: a value depends on \*PARAMETER"),
        ("3, 10.", "99999999999999999999, 10.", "line 4: .* is too large a number"),
        ("3, 10.", "0, 10.", "line 4: .*'0' is not the number of a node"),
        ("3, 10.", "3, 1., 2., 3., 4., 5., 6., 7., 8.", "line 4: .* fields, more than a number"),
        ("*NODE", "*NODE, FILE=x", "line 1: fedic does not know the parameter 'FILE' of .NODE"),
        ("*NODE", "*NOD", r"line 1: the keyword \*NOD is abbreviated; write \*NODE"),
        ("*NODE", "*IMPERFECTION, FILE=buckling, STEP=1\n1, 0.1\n*NODE", r"line 1: \*IMPERFECTION changes the mesh"),
        ("*NODE", "*IMPORT, STATE=NO\n*NODE", r"\*IMPORT changes the mesh"),
        ("*NODE", "*SYMMETRIC MODEL GENERATION, REVOLVE\n*NODE", "changes the mesh"),
        ("2, 2, 5, 6, 3", "2, 2, 5, 6, 99999999999999999999", "line 10: .* is too large a number"),
        ("2, 2, 5, 6, 3", "2, 2, 5, 6, 3.", r"line 10: .*'3\.' is not a whole number"),
        ("2, 2, 5, 6, 3", "2, 2, 5, 6, -3", "line 10: .*'-3' is not the number of a node"),
        ("TYPE=CPS4, ", "", "needs the element type"),
        ("TYPE=CPS4", "TYPE=CPS4, OFFSET=5", "parameter OFFSET"),
    ],
)
def test_what_is_not_understood_is_refused_by_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = tmp_path / "plate.inp"
    path.write_text(DECK.replace(old, new, 1))
    with pytest.raises(fedic.MeshError, match=message) as error:
        fedic.read_mesh(path)
    assert str(error.value).startswith(str(path))


@pytest.mark.parametrize(
    "text",
    [
        "*INCLUDE, INPUT=.\\sub\\deck one.inp\n",
        '*Include,\n input="sub/deck one.inp"\n',
        "*INCLUDE,INPUT=sub/deck one.inp",
    ],
)
def test_included_files_are_found(tmp_path: Path, text: str) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "deck one.inp").write_text("*INCLUDE, INPUT=nodes.inp\n*INCLUDE, INPUT=beside main.txt\n")
    (tmp_path / "sub" / "nodes.inp").write_text(f"*NODE\n{NODES}")
    (tmp_path / "beside main.txt").write_text(DECK[DECK.index("*ELEMENT") :])
    (tmp_path / "main.inp").write_text(text)
    assert_two_cells(tmp_path / "main.inp")


def test_data_lines_may_be_in_a_file_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "nodes.txt").write_text(f"** nodes\n{NODES}")
    (tmp_path / "elements.txt").write_text(ELEMENTS[:14])
    path = tmp_path / "main.inp"
    path.write_text(
        f"*NODE, INPUT=nodes.txt\n*ELEMENT, TYPE=CPS4, INPUT='elements.txt'\n{ELEMENTS[14:]}".replace("'", '"')
    )
    assert_two_cells(path)
    (tmp_path / "nodes.txt").write_text(f"*NODE\n{NODES}")
    with pytest.raises(fedic.MeshError, match=r"nodes\.txt, line 1: a file given by INPUT= holds data lines only"):
        fedic.read_mesh(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("*INCLUDE, INPUT=none.inp", r"main\.inp, line 1: the included file 'none\.inp' does not exist"),
        ("*INCLUDE", "line 1: .INCLUDE needs the name of a file"),
        ("*INCLUDE, INPUT=x, PASSWORD=y", "the included file is encrypted"),
        ("*INCLUDE, INPUT=.", "is no regular file"),
        ("*INCLUDE, INPUT=/dev/zero", "is no regular file"),
        ("*INCLUDE, INPUT=pipe", "is no regular file"),
    ],
)
def test_included_files_that_are_none_are_refused(tmp_path: Path, text: str, message: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "main.inp").write_text(text)
    with pytest.raises(fedic.MeshError, match=message):
        fedic.read_mesh(tmp_path / "main.inp")


def test_depth_and_number_of_included_files_are_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for number in range(30):
        (tmp_path / f"{number}.inp").write_text(f"*INCLUDE, INPUT={number + 1}.inp\n")
    with pytest.raises(fedic.MeshError, match="20 deep and deeper"):
        fedic.read_mesh(tmp_path / "0.inp")
    for number in range(4):
        (tmp_path / f"{number}.inp").write_text(f"*INCLUDE, INPUT={number + 1}.inp\n" * 3)
    (tmp_path / "4.inp").write_text(DECK)
    monkeypatch.setattr(_includes, "MAX_FILES", 20)
    with pytest.raises(fedic.MeshError, match="more than 20 files"):
        fedic.read_mesh(tmp_path / "0.inp")


def test_the_size_of_all_included_files_is_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "deck.inp").write_text(DECK)
    (tmp_path / "main.inp").write_text("*INCLUDE, INPUT=deck.inp\n" * 9)
    monkeypatch.setattr(_includes, "MAX_BYTES", 1000)
    with pytest.raises(fedic.MeshError, match="the mesh and the files it includes are larger"):
        fedic.read_mesh(tmp_path / "main.inp")


def test_a_message_shows_only_the_beginning_of_what_a_file_holds(tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("name:and:a:long:secret:hash,1,2\n")
    (tmp_path / "main.inp").write_text("*NODE\n*INCLUDE, INPUT=secret\n")
    with pytest.raises(fedic.MeshError, match=r"secret, line 1: not a valid line of \*NODE") as error:
        fedic.read_mesh(tmp_path / "main.inp")
    assert "long" not in str(error.value)


@settings(deadline=None, max_examples=50)
@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from("eEdD"))
def test_numbers_with_any_exponent_letter_are_the_same(value: float, letter: str) -> None:
    text = f"{value:.17e}"
    assert real(text.replace("e", letter)) == value
    assert real(text.replace("e", "")) == value
