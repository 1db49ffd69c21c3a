"""Abaqus models of parts and instances: their place, their sets, their surfaces."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fedic
from scenes.abaqus_models import PIN, PLATE, assembly, contents, instance, surface_points


def test_an_instance_is_moved_and_then_turned(tmp_path: Path) -> None:
    placed = instance("Plate-1", "PLATE", "10., 20., 0.", "10., 20., 0., 10., 20., 1., 90.")
    file = contents(tmp_path, PLATE + assembly(placed))
    np.testing.assert_array_equal(file.points, [[10, 20, 0], [10, 22, 0], [9, 22, 0], [9, 20, 0]])
    mesh = fedic.read_mesh(tmp_path / "model.inp")
    assert mesh.points.shape == (4, 2)
    assert set(mesh.sets) == {"Body", "Left"}


@settings(deadline=None, max_examples=50)
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
    mesh = fedic.read_mesh(tmp_path / "model.inp")
    assert (mesh.num_cells, mesh.points.shape) == (1, (8, 2))
    assert fedic.read_mesh(f"{tmp_path / 'model.inp'}#{name}").points.shape == (8, 3)


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
    chosen = fedic.read_mesh(f"{tmp_path / 'model.inp'}#Other")
    assert chosen.sets["Other.Body"].cells.tolist() == [0]
    with pytest.raises(fedic.MeshError, match=r"2 parts .* select one: model\.inp#Plate, model\.inp#Other\.$"):
        fedic.read_mesh(tmp_path / "model.inp")


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
        (PLATE + assembly("*Instance, library=x, instance=A\n"), r"\*INSTANCE needs a name"),
        (PLATE + assembly("*Instance, name=A, library=x, instance=A\n"), "takes the mesh from another analysis"),
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
