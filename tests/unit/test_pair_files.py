"""Tables of point pairs as people and spreadsheets write them: read right, or refused with the line."""

import codecs
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fedic
from fedic.registration import read_pairs

POINTS = np.array([[0.5, 0.0], [10.5, 0.0], [0.5, 5.25]])
PIXELS = np.array([[75.25, 285.0], [155.5, 285.1], [75.0, 245.3]])
TABLE = "0.5;0;75.25;285\n10.5;0;155.5;285.1\n0.5;5.25;75;245.3\n"


def write(folder: Path, text: str | bytes) -> Path:
    path = folder / "pairs.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def check(path: Path, points: np.ndarray = POINTS, pixels: np.ndarray = PIXELS) -> None:
    found = read_pairs(path)
    np.testing.assert_array_equal(found[0], points)
    np.testing.assert_array_equal(found[1], pixels)


READ = {
    "semicolons": TABLE,
    "commas": TABLE.replace(";", ","),
    "commas and blanks": TABLE.replace(";", ", "),
    "blanks": TABLE.replace(";", "   "),
    "tabs": TABLE.replace(";", "\t"),
    "pairs of pairs": "0.5 0, 75.25 285\n10.5 0, 155.5 285.1\n0.5 5.25, 75 245.3\n",
    "pairs with commas": "0.5,0 75.25,285\n10.5,0 155.5,285.1\n0.5,5.25 75,245.3\n",
    "decimal commas and semicolons": TABLE.replace(".", ","),
    "decimal commas and tabs": TABLE.replace(".", ",").replace(";", "\t"),
    "decimal commas and blanks": TABLE.replace(".", ",").replace(";", " "),
    "quoted decimal commas": '"0,5",0,"75,25",285\n"10,5",0,"155,5","285,1"\n"0,5","5,25",75,"245,3"\n',
    "heading": "X [mm];Y [mm];u (px);v (px)\n" + TABLE,
    "heading and units": "x;y;u;v\nmm;mm;px;px\n" + TABLE,
    "title and heading": "Points of the plate\n\nX;Y;u;v\n" + TABLE,
    "another order": "u,v,point,X,Y\n75.25,285,a,0.5,0\n155.5,285.1,b,10.5,0\n75,245.3,c,0.5,5.25\n",
    "another order above commas": "u v X Y\n75.25,285,0.5,0\n155.5,285.1,10.5,0\n75,245.3,0.5,5.25\n",
    "numbers named": "no;X;Y;u;v\n1;0.5;0;75.25;285\n2;10.5;0;155.5;285.1\n3;0.5;5.25;75;245.3\n",
    "labels": "P1;0.5;0;75.25;285\nP2;10.5;0;155.5;285.1\nP3;0.5;5.25;75;245.3\n",
    "comments": "# pairs\n% of a plate\n// by hand\n" + TABLE.replace("285\n", "285 # left\n"),
    "empty lines and columns": "\n;;;;\n" + TABLE.replace("\n", ";;\n"),
    "end of line of Windows": TABLE.replace("\n", "\r\n"),
    "end of line of old Macs": TABLE.replace("\n", "\r"),
    "no end of line": TABLE.rstrip(),
    "signs and exponents": TABLE.replace("10.5", "+1.05e1"),
}


@pytest.mark.parametrize("text", READ.values(), ids=READ)
def test_tables_are_read(tmp_path: Path, text: str) -> None:
    check(write(tmp_path, text))


@pytest.mark.parametrize(
    ("mark", "encoding"),
    [
        (codecs.BOM_UTF8, "utf-8"),
        (codecs.BOM_UTF16_LE, "utf-16-le"),
        (codecs.BOM_UTF16_BE, "utf-16-be"),
        (b"", "cp1252"),
    ],
)
def test_encodings_of_spreadsheets_are_read(tmp_path: Path, mark: bytes, encoding: str) -> None:
    text = "# Größe in µm\nX;Y;u;v\n" + TABLE.replace(".", ",")
    check(write(tmp_path, mark + text.encode(encoding)))


def test_signs_of_typesetting_are_read(tmp_path: Path) -> None:
    path = write(tmp_path, "\u22120,5;0;75;285\n")
    check(path, np.array([[-0.5, 0.0]]), np.array([[75.0, 285.0]]))


def test_points_in_space_are_read(tmp_path: Path) -> None:
    points, pixels = np.array([[0.0, 0.0, 1.5], [10.0, 0.0, 1.5]]), np.array([[75.0, 285.0], [155.0, 285.0]])
    for text in (
        "0 0 1.5 75 285\n10 0 1.5 155 285\n",
        "1 0 0 1.5 75 285\n2 10 0 1.5 155 285\n3 10 0 1.5 155 285\n",
        "Z;X;u;Y;v\n1,5;0;75;0;285\n1,5;10;155;0;285\n",
    ):
        found = read_pairs(write(tmp_path, text))
        np.testing.assert_array_equal(found[0][:2], points)
        np.testing.assert_array_equal(found[1][:2], pixels)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0 0 75 285\n10 0 nan 285\n", "'nan' in line 2 is not a finite number"),
        ("0 0 75 285\n10 0 1e999 285\n", "'1e999' in line 2 is not a finite number"),
        ("0 0 75 285\n10 0 inf 285\n", "'inf' in line 2 is not a finite number"),
        ("X;Y;u;v\n0;0;75;285\n10;;155;285\n", "a column in line 3 is empty"),
        ("0;0;75;285\n10;0;l55;285\n", "'l55' in line 2 is not a finite number"),
        ("0;0;75;285\n10;0;155\n", "line 2 has 3 columns and line 1 has 4"),
        ("X;Y;u;v\n0;0;75;285;9\n", "line 2 has 5 columns and the heading 4"),
        ("0 0 75\n", "3 numbers on a line; write X Y u v"),
        ("0 0 0 0 0 0 75 285\n", "8 numbers on a line"),
        ("1 0 0 75 285\n2 10 0 155 285\n3 0 5 75 245\n", "the first of five columns counts the lines"),
        ("a;b;c;d\n0;0;75;285\n", "the heading in line 1 does not name each of X, Y, u and v once"),
        ("X;Y;x;y\n0;0;75;285\n", "the heading in line 1 does not name"),
        ("0,5\t0\t75.5\t285\n", "'0,5' in line 1 has a comma and '75.5' in line 1 a point"),
        ("1,234\t500\t75\t285\n", "the comma of '1,234' in line 1 may separate thousands or decimals"),
        ("1,5 2 75 285\n", "the commas in line 1, '1,5 2 75 285', may separate numbers or decimals"),
        ("1.234,5;0;75;285\n", "'1.234,5' in line 1 is not a finite number"),
        ("", "no line with numbers"),
        ("# nothing\n", "no line with numbers"),
        ("\0\0\0", "no line with numbers|not of a table"),
        ("X;Y;u;v\n", "no line with numbers"),
    ],
)
def test_faults_are_named(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(fedic.CameraError, match=message) as caught:
        read_pairs(path)
    assert str(path) in str(caught.value)


def test_files_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    for path, message in ((tmp_path / "nothing.csv", "No such file"), (tmp_path, "not a regular file")):
        with pytest.raises(fedic.CameraError, match=message):
            read_pairs(path)
    with (tmp_path / "large.csv").open("wb") as file:
        file.truncate(2**25)
    with pytest.raises(fedic.CameraError, match="over 16 MB"):
        read_pairs(tmp_path / "large.csv")


@given(
    numbers=st.lists(st.tuples(*[st.floats(-1e4, 1e4).map(lambda x: round(x, 4))] * 4), min_size=1, max_size=6),
    style=st.sampled_from([(";", "."), ("\t", "."), (",", "."), (", ", "."), (" ", "."), (";", ","), ("\t", ",")]),
    heading=st.booleans(),
)
def test_what_is_written_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, numbers: list[tuple[float, ...]], style: tuple[str, str], heading: bool
) -> None:
    separator, point = style
    lines = [separator.join(repr(value).replace(".", point) for value in row) for row in numbers]
    if heading:
        lines.insert(0, separator.join("XYuv"))
    path = write(tmp_path_factory.mktemp("pairs"), "\n".join(lines))
    thousands = separator == "\t" and point == "," and all(value == round(value, 3) for row in numbers for value in row)
    try:
        points, pixels = read_pairs(path)
    except fedic.CameraError:
        assert thousands
        return
    np.testing.assert_array_equal(np.column_stack([points, pixels]), numbers)


@given(st.binary(max_size=200) | st.text(st.sampled_from('0123456789.,;\t\n "#XYuv-e'), max_size=200).map(str.encode))
def test_any_bytes_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    path = write(tmp_path_factory.mktemp("pairs"), data)
    try:
        points, pixels = read_pairs(path)
    except fedic.CameraError:
        return
    assert np.isfinite(points).all()
    assert pixels.shape == (len(points), 2)
