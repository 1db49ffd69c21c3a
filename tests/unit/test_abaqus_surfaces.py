"""Named surfaces of Abaqus: faces of solids, and shells."""

from pathlib import Path

import numpy as np
import pytest

import fedic
from scenes.abaqus_models import PLATE, SOLID, assembly, contents, instance, surface_points

SURFACES = ("Front", "Skin", "End")


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
    assert fedic.read_mesh(f"{tmp_path / 'model.inp'}#FRONT").areas() == pytest.approx([1.0, 1.0])


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
