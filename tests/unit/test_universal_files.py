"""Universal files of I-deas and Salome."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import fedic
from fedic.io.mesh_formats.unv import read_unv

POINTS = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 0, 0], [2, 1, 0], [1, 2, 0], [0, 1, 0]]


def dataset(number: int, *lines: str) -> str:
    return "\n".join(["    -1", f"{number:6d}", *lines, "    -1\n"])


def nodes(number: int = 2411, system: int = 1) -> str:
    lines = []
    for label, point in enumerate(POINTS, 1):
        if number == 15:
            lines.append(f"{label:10d}{system:10d}{1:10d}{11:10d}" + "".join(f"{x:13.5E}" for x in point))
        else:
            lines += [f"{label:10d}{system:10d}{1:10d}{11:10d}"]
            lines += ["".join(f"{x:25.16E}".replace("E", "D") for x in point)]
    return dataset(number, *lines)


def element(label: int, descriptor: int, members: Sequence[int], number: int = 2412) -> list[str]:
    head = (
        [label, descriptor, 1, 1, 7, len(members)]
        if number == 2412
        else [label, descriptor, 1, 1, 1, 1, 7, len(members)]
    )
    beam = [f"{0:10d}{1:10d}{1:10d}"] if descriptor in (11, 21, 22, 23, 24) else []
    rows = [members[start : start + 8] for start in range(0, len(members), 8)]
    return ["".join(f"{x:10d}" for x in head), *beam, *("".join(f"{x:10d}" for x in row) for row in rows)]


def group(number: int, name: str, *members: tuple[int, int]) -> str:
    size = 2 if number in (2429, 2430, 2432) else 4
    numbers = [x for member in members for x in (*member, *[0] * (size - 2))]
    rows = ["".join(f"{x:10d}" for x in numbers[start : start + 8]) for start in range(0, len(numbers), 8)]
    head = f"{1:10d}{0:10d}{0:10d}{0:10d}{0:10d}{0:10d}{0:10d}{len(members):10d}"
    return dataset(number, head, name, *rows)


UNITS = dataset(164, f"{5:10d}mm (milli-newton)   {2:10d}", "  1.0D+03  1.0D+03  1.0D+00", "  2.7D+02")


def read(tmp_path: Path, text: str) -> fedic.Mesh:
    (tmp_path / "plate.unv").write_text(text)
    return fedic.read_mesh(tmp_path / "plate.unv")


@pytest.mark.parametrize("node_set", [15, 781, 2411])
@pytest.mark.parametrize("element_set", [780, 2412])
@pytest.mark.parametrize("descriptor", [44, 54, 64, 74, 84, 94])
def test_quadrilaterals_of_all_families_are_read(
    tmp_path: Path, node_set: int, element_set: int, descriptor: int
) -> None:
    lines = element(1, 11, [1, 2], element_set) + element(2, descriptor, [1, 2, 3, 4], element_set)
    mesh = read(tmp_path, UNITS + nodes(node_set) + dataset(element_set, *lines))
    np.testing.assert_array_equal(mesh.points, np.array(POINTS)[:, :2])
    assert mesh.cells["quad"].tolist() == [[0, 1, 2, 3]]


def test_quadratic_cells_have_their_nodes_round_the_edge(tmp_path: Path) -> None:
    lines = element(1, 45, [1, 5, 2, 6, 3, 7, 4, 8])
    mesh = read(tmp_path, nodes() + dataset(2412, *lines))
    assert mesh.cells["quad8"].tolist() == [[*range(8)]]
    assert mesh.areas() == pytest.approx([4.0])


@pytest.mark.parametrize("number", [2467, 2477, 2435, 2452, 2429, 2430, 2432])
def test_groups_are_sets(tmp_path: Path, number: int) -> None:
    lines = element(7, 91, [1, 2, 3]) + element(8, 91, [1, 3, 4]) + element(9, 21, [1, 4])
    groups = (
        group(number, "upper", (8, 8))
        + group(number, "left side", (8, 9))
        + group(number, "two", (7, 1), (7, 3), (7, 4))
    )
    sets = read(tmp_path, nodes() + dataset(2412, *lines) + groups).sets
    found = {name: (each.nodes.tolist(), each.cells.tolist()) for name, each in sets.items()}
    assert found == {"upper": ([0, 2, 3], [1]), "left side": ([0, 3], []), "two": ([0, 2, 3], [])}


def systems(kind: int, shift: float) -> str:
    rows = ["  1.0D+00  0.0D+00  0.0D+00", "  0.0D+00  1.0D+00  0.0D+00", "  0.0D+00  0.0D+00  1.0D+00"]
    head = [f"{1:10d}", "Part", f"{1:10d}{kind:10d}{8:10d}", "Global"]
    return dataset(2420, *head, *rows, f"  {shift:.1E}  0.0D+00  0.0D+00".replace("E", "D"))


def test_only_the_global_system_is_read(tmp_path: Path) -> None:
    cells = dataset(2412, *element(1, 44, [1, 2, 3, 4]))
    assert read(tmp_path, systems(0, 0.0) + nodes() + cells).num_cells == 1
    for kind, shift in ((1, 0.0), (0, 5.0)):
        with pytest.raises(
            fedic.MeshError, match="node 1 is given in the coordinate system 1, which is not the global"
        ):
            read(tmp_path, nodes() + systems(kind, shift) + cells)


def test_solids_and_others_come_under_their_names(tmp_path: Path) -> None:
    lines = element(1, 115, [1, 2, 3, 4, 5, 6, 7, 8]) + element(2, 161, [1]) + element(3, 111, [1, 2, 3, 5])
    (tmp_path / "solid.unv").write_text(nodes() + dataset(2412, *lines))
    names = [name for name, _ in read_unv(tmp_path / "solid.unv").blocks]
    assert names == ["hexahedron", "tetra", "type 161 of 1 nodes"]
    with pytest.raises(fedic.MeshError, match=r"no surface cell .*hexahedron"):
        fedic.read_mesh(tmp_path / "solid.unv")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("not a mesh\n", "this is no universal file"),
        (nodes() + "    -1\n  2412\n", "line 20: the dataset that begins here has no end"),
        (nodes() + "    -1\n\n    -1\n", "line 21: the number of the dataset is missing"),
        (nodes() + dataset(2412, *element(1, 44, [1, 2, 3, 9])), "element 1 refers to node 9"),
        (nodes() + dataset(2412, *element(1, 44, [1, 2, 3, 4])[:1]), "line 23: the dataset 2412 ends in the middle"),
        (nodes() + dataset(2412, "         1        44"), "line 22: not a valid line of the dataset 2412"),
        (
            nodes().replace("0.0000000000000000D+00", "0.0000000000000000X+00", 1),
            "line 4: not a valid line .*is not a number",
        ),
        (
            nodes() + dataset(2412, *element(1, 44, [1, 2, 3, 4]), *element(1, 44, [1, 2, 3, 5])),
            "element 1 is defined a second",
        ),
        (dataset(15, " 99999999999999999999 0 0 0 1. 2. 3."), "is not the number of a node"),
    ],
)
def test_damaged_files_are_refused_by_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(fedic.MeshError, match=message):
        read(tmp_path, text)
