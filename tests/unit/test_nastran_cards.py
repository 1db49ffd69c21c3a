"""Marks of continuation lines, names of included files over several lines, and messages of incomplete cards."""

from pathlib import Path

import numpy as np
import pytest

import fedic

POINTS = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0))
GRIDS = "".join(f"GRID,{number},,{x},{y},0.\n" for number, (x, y) in enumerate(POINTS, 1))
QUAD = "CQUAD4,1,1,1,2,3,4\n"
POLAR = "GRID,1,1,10.,0.\nGRID,2,1,20.,0.\nGRID,3,1,20.,90.\nGRID,4,1,10.,90.\n"


@pytest.mark.parametrize(
    ("mark", "continuation"),
    [("CORD1", "+ORD1"), ("+ORD1", "+ORD1"), (" ORD1", "+ORD1"), ("ORD1", "+ORD1"), ("", "+"), ("+A", "+"), ("", "+A")],
)
def test_the_first_column_of_a_mark_does_not_count(tmp_path: Path, mark: str, continuation: str) -> None:
    path = tmp_path / "ring.bdf"
    system = f"{'CORD2C':8}{1:8d}{'':40}{'1.':>16}".ljust(72)
    path.write_text(f"{system}{mark}\n{continuation:8}1.\n{POLAR}{QUAD}")
    np.testing.assert_allclose(fedic.read_mesh(path).points, [(10, 0), (20, 0), (0, 20), (0, 10)], atol=1e-12)


def test_a_mark_of_another_card_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "ring.bdf"
    path.write_text(f"{'CORD2C':8}{1:8d}".ljust(72) + f"+ORD1\n{'+ORD2':8}1.\n{POLAR}{QUAD}")
    with pytest.raises(fedic.MeshError, match="line 1: the lines of the card do not follow each other"):
        fedic.read_mesh(path)


@pytest.mark.parametrize("quote", ["'", '"'])
def test_the_name_of_an_included_file_may_go_on_over_several_lines(tmp_path: Path, quote: str) -> None:
    (tmp_path / "parts" / "of the plate").mkdir(parents=True)
    (tmp_path / "parts" / "of the plate" / "grids.bdf").write_text(GRIDS)
    path = tmp_path / "plate.bdf"
    path.write_text(f"INCLUDE {quote}parts/\nof the plate/\n   grids.bdf{quote}\n{QUAD}")
    np.testing.assert_array_equal(fedic.read_mesh(path).points, POINTS)


def test_a_name_that_does_not_end_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "plate.bdf"
    path.write_text(f"INCLUDE 'grids.bdf\n{GRIDS}{QUAD}")
    with pytest.raises(fedic.MeshError, match=r"line 1: the included file .* does not exist"):
        fedic.read_mesh(path)


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("CQUAD4,1,1,1,2,3", "CQUAD4 element 1 lacks the nodes 4 of 4; complete the card."),
        ("CQUAD8,1,1,1,2,3,4,1", "CQUAD8 element 1 lacks the nodes 6, 7, 8 of 8; give all nodes in the middle"),
    ],
)
def test_what_to_do_about_missing_nodes_is_said(tmp_path: Path, card: str, message: str) -> None:
    path = tmp_path / "plate.bdf"
    path.write_text(f"{GRIDS}{card}\n")
    with pytest.raises(fedic.MeshError, match=message):
        fedic.read_mesh(path)


@pytest.mark.parametrize(
    ("cards", "line"),
    [
        (f"{GRIDS}GRID,5,,20.,0.,0.\nGRID,6,,20.,10.,0.\n{QUAD}=,*1,=,2,5,6,3\n", 8),
        (f"{GRIDS}=,*1,=,*10.,==\n=1\n{QUAD}", 5),
        (f"{GRIDS}{QUAD}=(2)\n", 6),
    ],
)
def test_repeated_nodes_and_elements_are_refused(tmp_path: Path, cards: str, line: int) -> None:
    path = tmp_path / "plate.bdf"
    path.write_text(cards)
    with pytest.raises(fedic.MeshError, match=f"line {line}: this card repeats the one before"):
        fedic.read_mesh(path)


def test_repeated_loads_are_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "plate.bdf"
    path.write_text(f"{GRIDS}{QUAD}DEFORM,4,101,.05\n=,=,107,=\n=(3)\n")
    assert fedic.read_mesh(path).num_cells == 1
