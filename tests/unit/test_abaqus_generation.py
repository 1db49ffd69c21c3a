"""Abaqus keywords that generate, copy, turn and map nodes and elements."""

from pathlib import Path

import numpy as np
import pytest

import fedic

PLATE = "*NODE, NSET=BASE\n1, 0., 0.\n5, 8., 0.\n41, 0., 6.\n45, 8., 6.\n"
FILL = "*NGEN, NSET=BOTTOM\n1, 5\n*NGEN, NSET=TOP\n41, 45\n*NFILL, NSET=ALL\nBOTTOM, TOP, 4, 10\n"
ELGEN = "*ELEMENT, TYPE=CPS4\n1, 1, 2, 12, 11\n*ELGEN, ELSET=PLATE\n1, 4, 1, 1, 4, 10, 10\n"


def read(tmp_path: Path, text: str) -> fedic.Mesh:
    (tmp_path / "deck.inp").write_text(text)
    return fedic.read_mesh(tmp_path / "deck.inp")


def test_lines_are_filled_and_elements_generated(tmp_path: Path) -> None:
    mesh = read(tmp_path, PLATE + FILL + ELGEN)
    assert (mesh.num_nodes, mesh.num_cells) == (25, 16)
    assert mesh.areas() == pytest.approx(np.full(16, 3.0))
    assert len(mesh.sets["PLATE"].cells) == 16
    assert len(mesh.sets["ALL"].nodes) == 25
    np.testing.assert_allclose(np.sort(mesh.points[mesh.sets["TOP"].nodes, 0]), [0, 2, 4, 6, 8])


def test_bias_crowds_nodes_at_the_first_set(tmp_path: Path) -> None:
    mesh = read(tmp_path, PLATE + FILL.replace("*NFILL,", "*NFILL, BIAS=0.5,") + ELGEN)
    heights = np.unique(mesh.points[:, 1].round(9))
    np.testing.assert_allclose(np.diff(heights), [0.4, 0.8, 1.6, 3.2])


def test_unsorted_sets_are_filled_in_their_order(tmp_path: Path) -> None:
    nodes = "*NODE\n1, 0., 0.\n2, 1., 0.\n11, 1., 1.\n12, 0., 1.\n21, 0., 2.\n22, 1., 2.\n"
    sets = "*NSET, NSET=A, UNSORTED\n2, 1\n*NSET, NSET=B, UNSORTED\n22, 21\n*NFILL\nA, B, 2, 10\n"
    mesh = read(tmp_path, nodes + sets + "*ELEMENT, TYPE=CPS4\n1, 1, 2, 12, 11\n2, 11, 12, 22, 21\n")
    assert mesh.areas() == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize("centre", ["9", ", 0., 0.", ", , , 0."])
def test_arcs_are_generated(tmp_path: Path, centre: str) -> None:
    nodes = "*NODE\n1, 1., 0.\n7, 0., 1.\n11, 2., 0.\n17, 0., 2.\n9, 0., 0.\n"
    arcs = f"*NGEN, LINE=C\n1, 7, 1, {centre}\n11, 17, 1, {centre}\n"
    mesh = read(tmp_path, nodes + arcs + "*ELEMENT, TYPE=CPS4\n1, 1, 11, 12, 2\n*ELGEN\n1, 6\n")
    used = np.unique(mesh.cells["quad"])
    radii = np.linalg.norm(mesh.points[used], axis=1)
    assert sorted(radii.round(12)) == [1.0] * 7 + [2.0] * 7
    assert mesh.areas() == pytest.approx(np.full(6, 1.5 * np.sin(np.pi / 12)))


def test_an_arc_with_a_normal_may_be_longer_than_half_a_turn(tmp_path: Path) -> None:
    nodes = "*NODE\n1, 1., 0.\n4, 0., -1.\n11, 2., 0.\n14, 0., -2.\n"
    arcs = "*NGEN, LINE=C\n1, 4, 1, , 0., 0., 0., 0., 0., 1.\n11, 14, 1, , 0., 0., 0., 0., 0., 1.\n"
    mesh = read(tmp_path, nodes + arcs + "*ELEMENT, TYPE=CPS4\n1, 1, 11, 12, 2\n*ELGEN\n1, 3\n")
    np.testing.assert_allclose(mesh.points[4:6], [[0, 1], [-1, 0]], atol=1e-12)


def test_cylindrical_nodes_lie_in_the_system_of_the_part(tmp_path: Path) -> None:
    text = "*SYSTEM\n100., 50., 0., 100., 51., 0.\n*NODE, SYSTEM=C\n1, 1., 0.\n2, 2., 0.\n3, 2., 90.\n4, 1., 90.\n"
    text += "*SYSTEM\n*NODE\n5, 0., 0.\n*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n"
    mesh = read(tmp_path, text)
    np.testing.assert_allclose(mesh.points, [[100, 51], [100, 52], [98, 50], [99, 50], [0, 0]], atol=1e-12)


@pytest.mark.parametrize(
    ("system", "expected"),
    [
        ("5., 6., 7.", [6, 8, 10]),
        ("5., 6., 7., 5., 9., 7.", [3, 7, 10]),
        ("5., 6., 7., 5., 9., 11.", [3, 7, 10]),
        ("0., 0., 0., 0., 1., 0.\n0., 5., 1.", [3, 1, 2]),
    ],
)
def test_a_system_turns_nodes(tmp_path: Path, system: str, expected: list[float]) -> None:
    text = f"*SYSTEM\n{system}\n*NODE\n1, 0., 0., 0.\n2, 1., 2., 3.\n3, 4., 0., 1.\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n"
    mesh = read(tmp_path, text)
    np.testing.assert_allclose(mesh.points[1], expected, atol=1e-12)


COPY = "*NODE, NSET=OLD\n1, 1., 0.\n2, 2., 0.\n3, 2., 1.\n4, 1., 1.\n*ELEMENT, TYPE=CPS4, ELSET=OLD\n1, 1, 2, 3, 4\n"


@pytest.mark.parametrize(
    ("parameters", "lines", "corner"),
    [
        ("SHIFT", "5., 6.", (6, 6)),
        ("SHIFT", "0., 0., 0.\n0., 0., 0., 0., 0., 1., 90.", (0, 1)),
        ("SHIFT", "1., 0., 0.\n0., 0., 0., 0., 0., 1., 90.", (0, 2)),
        ("REFLECT=POINT", "0., 0., 0.", (-1, 0)),
        ("REFLECT=LINE", "0., 5., 0., 1., 5., 0.", (1, 10)),
        ("REFLECT=MIRROR", "0., 0., 0., 0., 1., 0.\n0., 0., 1.", (-1, 0)),
    ],
)
def test_nodes_and_elements_are_copied(
    tmp_path: Path, parameters: str, lines: str, corner: tuple[float, float]
) -> None:
    text = f"{COPY}*NCOPY, CHANGE NUMBER=10, OLD SET=OLD, NEW SET=NEW, {parameters}\n{lines}\n"
    text += "*ELCOPY, OLD SET=OLD, NEW SET=NEW, ELEMENT SHIFT=7, SHIFT NODES=10\n"
    mesh = read(tmp_path, text)
    assert mesh.areas() == pytest.approx([1.0, 1.0])
    assert mesh.sets["NEW"].cells.tolist() == [1]
    np.testing.assert_allclose(mesh.points[mesh.cells["quad"][1, 0]], corner, atol=1e-12)


def test_nodes_are_copied_several_times(tmp_path: Path) -> None:
    text = f"{COPY}*NCOPY, CHANGE NUMBER=10, OLD SET=OLD, SHIFT, MULTIPLE=3\n0.\n0., 0., 0., 0., 0., 1., 90.\n"
    mesh = read(tmp_path, text + "*ELGEN\n1, 4, 10\n")
    np.testing.assert_allclose(mesh.points[mesh.cells["quad"][:, 0]], [[1, 0], [0, 1], [-1, 0], [0, -1]], atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "lines", "corner"),
    [
        ("RECTANGULAR", "10., 20., 0.", (11, 20)),
        ("RECTANGULAR", "0., 0., 0., 0., 1., 0.\n-1., 0., 0.\n2., 2.", (0, 2)),
        ("CYLINDRICAL", "0., 0., 0., 0., 0., 1.\n0., 1., 0.\n1., 90.", (0, 1)),
    ],
)
def test_nodes_are_mapped(tmp_path: Path, kind: str, lines: str, corner: tuple[float, float]) -> None:
    mesh = read(tmp_path, f"{COPY}*NMAP, NSET=OLD, TYPE={kind}\n{lines}\n")
    np.testing.assert_allclose(mesh.points[0], corner, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("*NODE, SYSTEM=S\n9, 1., 0., 0.\n", r"line 8: \*NODE, SYSTEM=S is not read"),
        ("*NGEN, LINE=P\n1, 2, 1, 3\n", r"line 8: \*NGEN, LINE=P is not read"),
        ("*NGEN, LINE=C\n1, 3, 1, , 0., 0., 0.\n", r"line 9: .*the two ends are not equally far"),
        ("*NGEN, LINE=C\n1, 3, 1\n", "line 9: .*centre of the circle is missing"),
        ("*NGEN\n1, 4, 2\n", "line 9: .*1 and 4 do not differ by a multiple of 2"),
        ("*NGEN\n1, 99\n", "line 9: .*node 99 is not defined before this line"),
        ("*NGEN\n1, 900000000\n", "line 9: .*with 899999998 more, over 5000000"),
        ("*NFILL, SINGULAR=1\nOLD, OLD, 1\n", r"\*NFILL, SINGULAR is not read"),
        ("*NFILL, TWO STEP\nOLD, OLD, 1\n", r"\*NFILL, TWOSTEP is not read"),
        ("*NFILL\nOLD, NONE, 1\n", "line 9: .*the node set 'NONE' is not defined before this line"),
        ("*NFILL\nOLD, OLD, 2\n", "nodes 1 and 1 do not differ by 2 intervals"),
        ("*NCOPY, POLE, CHANGE NUMBER=1, OLD SET=OLD\n0.\n", r"\*NCOPY, POLE is not read"),
        ("*NCOPY, CHANGE NUMBER=9, OLD SET=OLD, SHIFT, MULTIPLE=9999999\n1.\n", "with 39999996 more, over 5000000"),
        ("*NMAP, NSET=OLD, TYPE=SPHERICAL\n0.\n", r"line 8: \*NMAP, TYPE=SPHERICAL is not read"),
        ("*SYSTEM\n0., 0., 0., 1., 0., 0.\n2., 0., 0.\n", "line 9: .*points of the coordinate system lie on one line"),
        ("*ELGEN\n5, 2\n", "line 9: .*element 5 is not defined before this line"),
        ("*ELGEN\n1, 99999, 1, 1, 99999\n", "line 9: .*with 9999800001 more, over 5000000"),
        ("*ELGEN\n1, 2, -3\n", "line 9: .*is not the number of a node"),
        ("*ELCOPY, OLD SET=NO, ELEMENT SHIFT=1, SHIFT NODES=0\n", "the element set 'NO' is not defined before"),
    ],
)
def test_generation_that_is_not_known_is_refused_by_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(fedic.MeshError, match=message):
        read(tmp_path, COPY + text)
