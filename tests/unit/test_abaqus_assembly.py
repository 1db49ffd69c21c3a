"""Abaqus models of parts and instances: their place, their sets, their surfaces."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fedic
from fedic.io._mesh_file import MeshFile
from fedic.io.abaqus import read_abaqus

PLATE = """\
*Part, name=Plate
*Node
10, 0., 0., 0.
20, 2., 0., 0.
30, 2., 1., 0.
40, 0., 1., 0.
*Element, type=CPS4R, elset=Body
1, 10, 20, 30, 40
*Nset, nset=Left
10, 40
*End Part
"""
SURFACES = ("Front", "Skin", "End")
PIN = """\
*Part, name=Pin
*Node
1, 5., 5., 1.
2, 6., 5., 1.
3, 6., 6., -1.
4, 5., 6., -1.
*Element, type=R3D4, elset=Skin
1, 1, 2, 3, 4
*End Part
"""
SOLID = """\
*Part, name=Block
*Node
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 2., 0., 0.
10, 2., 1., 0.
11, 2., 0., 1.
12, 2., 1., 1.
*Element, type=C3D8R, elset=Body
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 2, 9, 10, 3, 6, 11, 12, 7
*Elset, elset=Both, generate
1, 2
*Surface, name=Front, type=ELEMENT
Both, S2
*Surface, name=Skin
Body,
*Surface, name=End
2, S4
*End Part
"""


def instance(name: str, part: str, *lines: str) -> str:
    return "\n".join([f"*Instance, name={name}, part={part}", *lines, "*End Instance\n"])


def assembly(*instances: str) -> str:
    return f"*Assembly, name=Assembly\n{''.join(instances)}*End Assembly\n"


def contents(tmp_path: Path, text: str) -> MeshFile:
    (tmp_path / "model.inp").write_text(text)
    return read_abaqus(tmp_path / "model.inp")


def surface_points(file: MeshFile, name: str) -> np.ndarray:
    return np.concatenate([file.points[nodes].reshape(-1, 3) for _, nodes in file.surfaces[name]])


def test_an_instance_is_moved_and_then_turned(tmp_path: Path) -> None:
    placed = instance("Plate-1", "PLATE", "10., 20., 0.", "10., 20., 0., 10., 20., 1., 90.")
    file = contents(tmp_path, PLATE + assembly(placed))
    np.testing.assert_array_equal(file.points, [[10, 20, 0], [10, 22, 0], [9, 22, 0], [9, 20, 0]])
    mesh = fedic.read_mesh(tmp_path / "model.inp")
    assert mesh.points.shape == (4, 2)
    assert set(mesh.sets) == {"Body", "Left"}


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3),
    st.lists(st.floats(-10, 10), min_size=3, max_size=3),
    st.floats(-720, 720),
)
def test_placing_keeps_lengths_and_points_of_the_axis(
    tmp_path_factory: pytest.TempPathFactory, shift: list[float], axis: list[float], angle: float
) -> None:
    axis[2] += 20.0
    lines = [
        ", ".join(f"{x!r}" for x in numbers) for numbers in (shift, [*shift, *np.add(shift, axis).tolist(), angle])
    ]
    file = contents(tmp_path_factory.mktemp("placed"), PLATE + assembly(instance("I", "Plate", *lines)))
    start = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], dtype=float)
    np.testing.assert_allclose(file.points[0], shift, atol=1e-9)
    lengths = [np.linalg.norm(points[:, None] - points[None], axis=2) for points in (file.points, start)]
    np.testing.assert_allclose(lengths[0], lengths[1], atol=1e-9)
    along = (file.points - file.points[0]) @ axis
    np.testing.assert_allclose(along, start @ axis, atol=1e-9)


def test_several_instances_are_one_mesh_with_a_set_each(tmp_path: Path) -> None:
    instances = [instance("A", "Plate"), instance("B", "Plate", "5., 0., 0.")]
    common = (
        "*Nset, nset=Ends, instance=A\n10,\n*Nset, nset=Ends, instance=B\nLeft, 20\n*Elset, elset=All\nA.Body, B.1\n"
    )
    text = PLATE + assembly(*instances).replace("*End Assembly", f"{common}*End Assembly")
    contents(tmp_path, text)
    mesh = fedic.read_mesh(tmp_path / "model.inp")
    assert mesh.points[:, 0].tolist() == [0, 2, 2, 0, 5, 7, 7, 5]
    assert mesh.areas() == pytest.approx([2.0, 2.0])
    found = {name: (each.nodes.tolist(), each.cells.tolist()) for name, each in mesh.sets.items()}
    assert found == {
        "A": ([0, 1, 2, 3], [0]),
        "A.Body": ([0, 1, 2, 3], [0]),
        "A.Left": ([0, 3], []),
        "B": ([4, 5, 6, 7], [1]),
        "B.Body": ([4, 5, 6, 7], [1]),
        "B.Left": ([4, 7], []),
        "Ends": ([0, 4, 5, 7], []),
        "All": ([0, 1, 2, 3, 4, 5, 6, 7], [0, 1]),
    }


def test_instances_of_several_parts_come_in_their_order(tmp_path: Path) -> None:
    other = PLATE.replace("Plate", "Other").replace("2., 1.", "3., 1.")
    file = contents(tmp_path, PLATE + other + assembly(instance("Y", "Other"), instance("X", "Plate", "9., 9., 9.")))
    np.testing.assert_array_equal(file.points[2], [3, 1, 0])
    np.testing.assert_array_equal(file.points[4], [9, 9, 9])


def test_nodes_and_elements_may_stand_in_the_instance(tmp_path: Path) -> None:
    body = PLATE.split("\n", 1)[1].replace("*End Part\n", "")
    text = f"*Assembly, name=A\n*Instance, name=Plate-1\n1., 2., 0.\n{body}*End Instance\n*End Assembly\n"
    np.testing.assert_array_equal(contents(tmp_path, text).points[2], [3, 3, 0])
    part = PLATE.replace("*Nset", "*Element, type=T2D2\n9, 10, 20\n*Nset")
    mixed = "*Part, name=Void\n*End Part\n" + text.replace("name=Plate-1", "name=Plate-1, part=Void")
    assert contents(tmp_path, part + mixed).points.shape == (4, 3)


def test_names_of_the_only_instance_can_be_selected(tmp_path: Path) -> None:
    file = contents(tmp_path, PLATE + assembly(instance("Plate-1", "Plate")))
    assert set(file.cell_sets) == {"Body"}
    found = {name: [rows.tolist() for rows in members] for name, members in file.parts.items()}
    assert found == {"Plate-1": [[0]], "Plate": [[0]], "Plate-1.Body": [[0]], "Plate.Body": [[0]]}


@pytest.mark.parametrize("placed", [True, False])
def test_a_rigid_part_is_left_out_and_can_be_selected(tmp_path: Path, placed: bool) -> None:
    instances = assembly(instance("Pin-1", "Pin"), instance("Plate-1", "Plate")) if placed else ""
    file = contents(tmp_path, PIN + PLATE + instances)
    assert [(name, len(nodes)) for name, nodes in file.blocks] == [("quad", 1)]
    name = "Pin-1" if placed else "Pin"
    assert {name, f"{name}.Skin"} <= set(file.surfaces)
    assert surface_points(file, name).max() == 6.0
    assert fedic.read_mesh(tmp_path / "model.inp").num_cells == 1


def test_rigid_elements_without_parts_need_a_rigid_body(tmp_path: Path) -> None:
    def body(text: str) -> str:
        return "\n".join(text.splitlines()[1:-1]) + "\n"

    text = body(PLATE) + body(PIN.replace("\n1, 1,", "\n7, 1,"))
    assert len(contents(tmp_path, text).surface_cells()["quad"]) == 2
    file = contents(tmp_path, f"{text}*Rigid Body, ref node=1, elset=Skin\n")
    assert len(file.surface_cells()["quad"]) == 1
    assert list(file.surfaces) == ["Skin"]
    assert len(contents(tmp_path, PIN).surface_cells()["quad"]) == 1


def test_several_parts_without_an_assembly_need_a_selection(tmp_path: Path) -> None:
    file = contents(tmp_path, PLATE + PLATE.replace("Plate", "Other"))
    assert {"Plate", "Plate.Body", "Other"} <= set(file.cell_sets)
    with pytest.raises(fedic.MeshError, match=r"2 parts .* select one: model\.inp#Plate, model\.inp#Other\.$"):
        fedic.read_mesh(tmp_path / "model.inp")


def test_surfaces_of_solids_are_kept_apart(tmp_path: Path) -> None:
    file = contents(tmp_path, SOLID + assembly(instance("Block-1", "Block", "0., 0., 5.")))
    assert [(name, nodes.shape) for name, nodes in file.blocks] == [("hexahedron", (2, 8))]
    assert file.cell_sets["Body"][0].tolist() == [0, 1]
    ((cell, front),) = file.surfaces["Front"]
    assert (cell, front.shape) == ("quad", (2, 4))
    assert set(surface_points(file, "Front")[:, 2]) == {6.0}
    assert set(file.surfaces) == {f"{prefix}{name}" for prefix in ("", "Block-1.", "Block.") for name in SURFACES}
    assert len(file.surfaces["Skin"][0][1]) == 10
    assert set(surface_points(file, "End")[:, 0]) == {2.0}
    with pytest.raises(fedic.MeshError, match="cells found: hexahedron"):
        fedic.read_mesh(tmp_path / "model.inp")


@pytest.mark.parametrize(
    ("face", "plane"), [("S1", (2, 0)), ("S2", (2, 1)), ("S3", (1, 0)), ("S4", (0, 1)), ("S5", (1, 1)), ("S6", (0, 0))]
)
def test_the_faces_of_a_hexahedron_are_those_of_abaqus(tmp_path: Path, face: str, plane: tuple[int, int]) -> None:
    text = SOLID.replace("*End Part", f"*Surface, name=One\n1, {face}\n*End Part")
    points = surface_points(contents(tmp_path, text), "One")
    assert set(points[:, plane[0]]) == {plane[1]}
    assert len(points) == 4


def test_surfaces_of_the_assembly_join_instances(tmp_path: Path) -> None:
    sets = "".join(f"*Elset, elset=_F, internal, instance={name}\nBoth,\n" for name in ("A", "B"))
    more = f"{sets}*Surface, type=ELEMENT, name=Fronts\n_F, S2\n*Surface, name=One\nB.Body, S1\n*End Assembly"
    instances = assembly(instance("A", "Block"), instance("B", "Block", "0., 9., 0."))
    file = contents(tmp_path, SOLID + instances.replace("*End Assembly", more))
    assert sum(len(nodes) for _, nodes in file.surfaces["Fronts"]) == 4
    assert set(surface_points(file, "One")[:, 1]) == {9.0, 10.0}
    assert {"A.Front", "B.Front", "A.Skin"} <= set(file.surfaces)


def test_quadratic_faces_have_their_middle_nodes(tmp_path: Path) -> None:
    corners = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]], dtype=float)
    edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    points = np.concatenate([corners, [corners[[a, b]].mean(axis=0) for a, b in edges]])
    nodes = "\n".join(f"{index}, {x}, {y}, {z}" for index, (x, y, z) in enumerate(points, 1))
    text = f"*NODE\n{nodes}\n*ELEMENT, TYPE=C3D10M\n1, 1, 2, 3, 4, 5, 6, 7,\n8, 9, 10\n*SURFACE, NAME=S\n1, S3\n"
    ((cell, face),) = contents(tmp_path, text).surfaces["S"]
    assert cell == "triangle6"
    corner, middle = points[face[0, :3]], points[face[0, 3:]]
    np.testing.assert_array_equal(middle, (corner + np.roll(corner, -1, axis=0)) / 2)


def test_shells_are_their_own_surface(tmp_path: Path) -> None:
    text = PLATE.replace("CPS4R", "S4R").replace("*End Part", "*Surface, name=Top\nBody, SPOS\n*End Part")
    file = contents(tmp_path, text + assembly(instance("P", "Plate")))
    assert file.surfaces["Top"][0][1].tolist() == [[0, 1, 2, 3]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PLATE + assembly(instance("A", "None")), r"line 13: the part 'None' of the instance is not in the file"),
        (PLATE + PLATE, "line 12: the part 'Plate' is defined a second time"),
        (PLATE + assembly(instance("A", "Plate"), instance("a", "Plate")), "the instance 'a' is defined a second time"),
        (PLATE + assembly(instance("A", "Plate", "1., 2., 3., 4., 5.")), "line 14: .*5 numbers"),
        (
            PLATE + assembly(instance("A", "Plate", "1., x")),
            "line 14: not a valid line of .INSTANCE .'x' is not a number",
        ),
        (PLATE + assembly(instance("A", "Plate", "0.", "1., 1., 1., 1., 1., 1., 9.")), "two points of the axis"),
        (PLATE + assembly("*Instance, library=x, instance=A\n"), "takes the mesh from another analysis|needs a name"),
        (PLATE.replace(", name=Plate", ""), "line 1: .PART needs a name"),
        (PLATE.replace("40\n*Nset", "41\n*Nset"), "element 1 refers to node 41"),
        (
            PLATE + assembly(instance("A", "Plate"), "*Nset, nset=S, instance=A\nnone\n"),
            "contains 'none', which is neither",
        ),
    ],
)
def test_models_that_make_no_sense_are_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(fedic.MeshError, match=message):
        contents(tmp_path, text)
