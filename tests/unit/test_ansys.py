"""Archive and input files of Ansys."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import fedic
from fedic.io.mesh_formats.ansys import read_ansys

POINTS = [[30, 30], [170, 30], [170, 130], [30, 130], [100, 30], [100, 130]]
QUADS = [[1, 5, 6, 4], [5, 2, 3, 6]]


def node_block(points: Sequence[Sequence[float]], solid: bool = True) -> str:
    head = f"NBLOCK,6,SOLID,{len(points)},{len(points)}\n(3i9,6e21.13e3)\n" if solid else "nblock,3\n(1i9,3e20.9e3)\n"
    rows = []
    for label, point in enumerate(points, 1):
        numbers = "".join(f"{x:21.13E}" if solid else f"{x:20.9E}" for x in point)
        rows.append(f"{label:9d}" + (f"{0:9d}{0:9d}" if solid else "") + numbers)
    return head + "\n".join(rows) + ("\nN,R5.3,LOC,       -1,\n" if solid else "\n-1\n")


def element_block(elements: Sequence[Sequence[int]], kind: int = 1, first: int = 1) -> str:
    rows = []
    for label, nodes in enumerate(elements, first):
        numbers = [1, kind, 1, 1, 0, 0, 0, 0, len(nodes), 0, label, *nodes]
        rows += ["".join(f"{x:9d}" for x in part) for part in (numbers[:19], numbers[19:]) if part]
    return f"EBLOCK,19,SOLID,{len(elements)},{len(elements)}\n(19i9)\n" + "\n".join(rows) + "\n       -1\n"


def compact_block(elements: Sequence[Sequence[int]], kind: int = 1) -> str:
    rows = ["".join(f"{x:9d}" for x in [i, kind, 1, 1, 0, *nodes]) for i, nodes in enumerate(elements, 1)]
    return f"eblock,10,,,{len(elements)}\n(15i9)\n" + "\n".join(rows) + "\n-1\n"


COMPONENTS = (
    "CMBLOCK,LEFT    ,NODE,       2\n(8i10)\n         1         4\nCMBLOCK,BOTH,ELEM,2  ! users component\n(8i10)\n"
    "         1        -2\n"
)
ARCHIVE = f"/COM,ANSYS RELEASE\n/PREP7\nET,1,PLANE182\n{node_block(POINTS)}{element_block(QUADS)}{COMPONENTS}FINISH\n"


def read(tmp_path: Path, text: str, name: str = "plate.cdb") -> fedic.Mesh:
    (tmp_path / name).write_text(text)
    return fedic.read_mesh(tmp_path / name)


@pytest.mark.parametrize("name", ["plate.cdb", "plate.inp", "plate.dat", "plate.CDB"])
def test_archives_are_told_by_their_contents(tmp_path: Path, name: str) -> None:
    mesh = read(tmp_path, ARCHIVE, name)
    np.testing.assert_array_equal(mesh.points, POINTS)
    np.testing.assert_array_equal(mesh.cells["quad"], np.array(QUADS) - 1)
    found = {name: (each.nodes.tolist(), each.cells.tolist()) for name, each in mesh.sets.items()}
    assert found == {"LEFT": ([0, 3], []), "BOTH": ([0, 1, 2, 3, 4, 5], [0, 1])}


COMMANDS = "".join(f"N,{i},{x},{y}\n" for i, (x, y) in enumerate(POINTS, 1))


@pytest.mark.parametrize(
    "text",
    [
        f"/prep7\net,1,181\n{node_block(POINTS, solid=False)}{element_block(QUADS)}",
        f"/prep7\net,1,181\n{node_block(POINTS, solid=False)}{compact_block(QUADS)}/solu\nesel,s,type,,1\n",
        f"*set,tid,1\net,tid,181\n{node_block(POINTS)}{compact_block(QUADS)}",
        "ETBLOCK,        1,        1\n(2i9,19a9)\n        1      182\n       -1\n"
        f"{node_block(POINTS)}{element_block(QUADS)}",
        f"/PREP7\nET,1,42 $ MP,EX,1,2E5\n{COMMANDS}E,1,5,6,4 $ E,5,2,3,6\n",
        f"/prep7\net,3,SHELL63\ntype,3\nw=100\n{COMMANDS.replace('100', 'W')}en,1,1,5,6,4\nEN,2,5,2,3,6 ! last\n",
        f"/PREP7\nET,1,MESH200,6\n{COMMANDS}E,1,5,6,4\nE,5,2,3,6\n",
        f"/PREP7\nET,1,200\nKEYOPT,1,1,6\n{node_block(POINTS)}{element_block(QUADS)}",
        f"/PREP7\nET,1,42\nET,2,CONTA172\nTYPE,2\n{COMMANDS}E,1,2\nTYPE,1\nE,1,5,6,4\nE,5,2,3,6\n",
    ],
)
def test_input_files_are_read(tmp_path: Path, text: str) -> None:
    mesh = read(tmp_path, text, "ds.dat")
    np.testing.assert_array_equal(mesh.points, POINTS)
    np.testing.assert_array_equal(mesh.cells["quad"], np.array(QUADS) - 1)


def test_columns_may_touch_and_may_be_too_narrow(tmp_path: Path) -> None:
    points = [[-30.0, -30.0, -1.0], [-1.7e100, -3e100, -1.0], [3.0, 4.0, -5.0]]
    text = f"ET,1,181\n{node_block(points)}"
    (tmp_path / "touching.cdb").write_text(text)
    np.testing.assert_array_equal(read_ansys(tmp_path / "touching.cdb").points, points)
    narrow = f"ET,1,181\n{node_block(POINTS)}".replace("E+0", "E+00").replace(" 3.", "  3.")
    (tmp_path / "narrow.cdb").write_text(narrow)
    np.testing.assert_array_equal(read_ansys(tmp_path / "narrow.cdb").points[:, :2], POINTS)
    (tmp_path / "glued.cdb").write_text(narrow.replace("        0   3.", "        0-3."))
    with pytest.raises(fedic.MeshError, match="line 4: not a valid line of NBLOCK"):
        read_ansys(tmp_path / "glued.cdb")


NINE = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]]


@pytest.mark.parametrize(
    ("kind", "nodes", "cell", "expected"),
    [
        ("PLANE182", [1, 2, 3, 3], "triangle", [1, 2, 3]),
        ("SHELL181", [1, 2, 3, 4], "quad", [1, 2, 3, 4]),
        ("PLANE183", [1, 2, 3, 4, 5, 6, 7, 8], "quad8", [1, 2, 3, 4, 5, 6, 7, 8]),
        ("PLANE183", [1, 2, 4, 4, 5, 9, 4, 8], "triangle6", [1, 2, 4, 5, 9, 8]),
        ("PLANE183", [1, 2, 4, 5, 9, 8], "triangle6", [1, 2, 4, 5, 9, 8]),
        ("SHELL281", [1, 2, 3, 4, 0, 0, 0, 0], "quad", [1, 2, 3, 4]),
        ("SHELL93", [1, 2, 4, 4], "triangle", [1, 2, 4]),
        ("PLANE2", [1, 2, 4, 5, 9, 8], "triangle6", [1, 2, 4, 5, 9, 8]),
    ],
)
def test_triangles_are_quadrilaterals_with_a_repeated_node(
    tmp_path: Path, kind: str, nodes: list[int], cell: str, expected: list[int]
) -> None:
    mesh = read(tmp_path, f"/PREP7\nET,1,{kind}\n{node_block(NINE)}{element_block([nodes])}")
    assert {name: (each + 1).tolist() for name, each in mesh.cells.items()} == {cell: [expected]}


CORNERS = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]])
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
HEXAHEDRON20 = np.concatenate([CORNERS, [CORNERS[[a, b]].mean(axis=0) for a, b in EDGES]])


@pytest.mark.parametrize(
    ("nodes", "linear", "cell"),
    [
        ("ABCDEFGHQRSTUVWXYZab", "hexahedron", "hexahedron20"),
        ("ABCCEFGGQRCTUVGXYZaa", "wedge", "wedge15"),
        ("ABCDEEEEQRSTEEEEYZab", "pyramid", "pyramid13"),
        ("ABCCEEEEQRCTEEEEYZaa", "tetra", "tetra10"),
    ],
)
def test_solids_are_hexahedra_with_repeated_nodes(tmp_path: Path, nodes: str, linear: str, cell: str) -> None:
    labels = ["ABCDEFGHQRSTUVWXYZab".index(letter) + 1 for letter in nodes]
    for number, count, name in (("185", 8, linear), ("186", 20, cell)):
        (tmp_path / "s.cdb").write_text(f"ET,1,{number}\n{node_block(HEXAHEDRON20)}{element_block([labels[:count]])}")
        ((found, table),) = read_ansys(tmp_path / "s.cdb").blocks
        assert found == name
        used = dict.fromkeys(labels[:count])
        assert set((table[0] + 1).tolist()) == set(used)
        assert (table[0] + 1).tolist()[:4] == list(used)[:4]


def test_nodes_may_be_given_in_cylindrical_coordinates(tmp_path: Path) -> None:
    mesh = read(tmp_path, "/PREP7\nET,1,42\nN,,1\nN,,2\nCSYS,1\nN,,2,90\nN,,1,90\nCSYS,0\nE,1,2,3,4\n")
    np.testing.assert_allclose(mesh.points, [[1, 0], [2, 0], [0, 2], [0, 1]], atol=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ET,1,PLANE182\n", "", "element 1 is of the type 1, which no ET command defines"),
        ("(3i9,6e21.13e3)", "", r"line 5: the format of the block, \(19i9\) for instance, is missing"),
        ("(3i9,6e21.13e3)", "(3i9)", "no columns for coordinates"),
        ("(3i9,6e21.13e3)", "(3i0,6e21.13e3)", "is missing or is not known"),
        ("(3i9,6e21.13e3)", "(99999999999999999999i9,6e21.13e3)", "is missing or is not known"),
        (
            "3.0000000000000E+01",
            "3.000000000000XE+01",
            r"line 6: not a valid line of NBLOCK \('3.0000000000...' is not",
        ),
        (
            "        1        5        6        4",
            "        1        0        6        4",
            "line 15: .*element 1 cannot be read: it has 3 nodes at its corners, not 4",
        ),
        (
            "        1        5        6        4\n",
            "        1        5        6       99\n",
            "element 1 refers to node 99",
        ),
        ("       -1\nCM", "CM", "not a valid line of EBLOCK"),
        ("FINISH", "AMESH,ALL", "line 24: AMESH makes or changes the mesh"),
        ("FINISH", "NGEN,2,10,ALL", "NGEN makes or changes the mesh"),
        ("FINISH", "*DO,I,1,4\nN,I,0,0\n*ENDDO", "line 25: N stands in a loop"),
        ("FINISH", "N,7,WIDTH", "line 24: not a valid line of N .'WIDTH' is not a number"),
        ("FINISH", "CSYS,12\nN,7,1,1", "nodes in the coordinate system 12 are not read"),
        ("FINISH", "N,R5.3,LOC,7,1.,1.", "unblocked nodes are not read"),
        ("FINISH", "EN,R5.5,ATTR,4,1,1", "unblocked elements are not read"),
        ("FINISH", "EBLOCK,19,COMPACT\n(19i9)\n-1", "blocks of the kind COMPACT are not read"),
        ("         1        -2\n", "", "line 23: not a valid line of CMBLOCK"),
    ],
)
def test_what_is_not_understood_is_refused_by_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in ARCHIVE
    with pytest.raises(fedic.MeshError, match=message):
        read(tmp_path, ARCHIVE.replace(old, new, 1))


def test_some_but_not_all_middle_nodes_are_refused(tmp_path: Path) -> None:
    text = f"/PREP7\nET,1,183\n{node_block(NINE)}{element_block([[1, 2, 3, 4, 5, 0, 7, 8]])}"
    with pytest.raises(fedic.MeshError, match="element 1 cannot be read: it has 3 of 4 nodes in the middle of edges"):
        read(tmp_path, text)
