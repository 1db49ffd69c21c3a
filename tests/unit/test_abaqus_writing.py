"""Abaqus input files that `Mesh.write` writes: the types of the elements, the numbers and the names of sets."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import fedic
from fedic import MeshSet

PLANE_TYPES = {"triangle": "CPS3", "triangle6": "CPS6", "quad": "CPS4", "quad8": "CPS8", "quad9": "M3D9"}
SPATIAL_TYPES = {"triangle": "M3D3", "triangle6": "M3D6", "quad": "M3D4", "quad8": "M3D8", "quad9": "M3D9"}


def lifted(mesh: fedic.Mesh) -> fedic.Mesh:
    return fedic.Mesh(np.column_stack([mesh.points, mesh.points[:, 0] ** 2]), mesh.cells, mesh.sets)


def types(path: Path) -> list[str]:
    return [line.partition("TYPE=")[2] for line in path.read_text().splitlines() if line.startswith("*ELEMENT")]


def written(mesh: fedic.Mesh, path: Path) -> fedic.Mesh:
    mesh.write(path)
    return fedic.read_mesh(path)


@pytest.mark.parametrize("cell", PLANE_TYPES)
def test_elements_are_of_plane_stress_in_a_plane_and_membranes_in_space(tmp_path: Path, cell: str) -> None:
    plane = fedic.rectangle_mesh((0, 0, 2, 1), 1.0, cell)
    plane.write(tmp_path / "plane.inp")
    lifted(plane).write(tmp_path / "space.inp")
    assert types(tmp_path / "plane.inp") == [PLANE_TYPES[cell]]
    assert types(tmp_path / "space.inp") == [SPATIAL_TYPES[cell]]


def test_all_elements_of_a_mesh_with_nine_nodes_are_membranes(tmp_path: Path) -> None:
    nine = fedic.rectangle_mesh((0, 0, 1, 1), 1.0, "quad9")
    points = np.concatenate([nine.points, [[2.0, 0.5]]])
    mesh = fedic.Mesh(points, {**nine.cells, "triangle": [[int(nine.cells["quad9"][0, 1]), 9, 5]]})
    mesh.write(tmp_path / "mesh.inp")
    assert types(tmp_path / "mesh.inp") == ["M3D9", "M3D3"]


def test_the_text_of_a_small_mesh(tmp_path: Path) -> None:
    points = [[0.0, 0.0], [1.5, 0.0], [1.5, 1.0], [0.0, 1.0]]
    sets = {"left": MeshSet(nodes=[0, 3]), "the whole": MeshSet(cells=[0])}
    fedic.Mesh(points, {"quad": [[0, 1, 2, 3]]}, sets).write(tmp_path / "mesh.inp")
    assert (tmp_path / "mesh.inp").read_text() == (
        "*HEADING\nmesh written by fedic\n"
        "*NODE\n1, 0.0, 0.0, 0.0\n2, 1.5, 0.0, 0.0\n3, 1.5, 1.0, 0.0\n4, 0.0, 1.0, 0.0\n"
        "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n"
        '*NSET, NSET=left\n1, 4\n*NSET, NSET="the whole"\n1, 2, 3, 4\n*ELSET, ELSET="the whole"\n1\n'
    )


def test_lines_hold_what_abaqus_allows(tmp_path: Path) -> None:
    mesh = fedic.rectangle_mesh((-1e-7 / 3, -1e5 / 3, 1e5 / 7, 1e5 / 9), 4000.0)
    mesh = mesh.with_sets({"all": MeshSet(nodes=np.arange(mesh.num_nodes), cells=np.arange(mesh.num_cells))})
    mesh.write(tmp_path / "mesh.inp")
    items = [line.split(", ") for line in (tmp_path / "mesh.inp").read_text().splitlines() if line[:1].isdigit()]
    assert max(map(len, items)) == 16
    assert max(len(item) for row in items for item in row) == 20


@settings(max_examples=200, deadline=None)
@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_coordinate_takes_twenty_columns_and_keeps_twelve_digits(value: float) -> None:
    from fedic.io.mesh_formats.abaqus.writer import _number

    assert len(_number(value)) <= 20
    assert float(_number(value)) == pytest.approx(value, rel=1e-12, abs=0.0)


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.dictionaries(st.text(st.characters(categories=["L", "N", "P", "S", "Zs"]), min_size=1), st.booleans()))
def test_names_of_sets_read_back_the_same_or_are_refused(tmp_path: Path, names: dict[str, bool]) -> None:
    sets = {name: MeshSet(cells=[1]) if cell else MeshSet(nodes=[1, 4]) for name, cell in names.items()}
    mesh = fedic.rectangle_mesh((0, 0, 2, 1), 1.0).with_sets(sets)
    try:
        read = written(mesh, tmp_path / "mesh.inp")
    except fedic.MeshError:
        return
    assert read.sets == mesh.sets


@pytest.mark.parametrize("name", ["left", "two words", "1", "a,b", "a=b", "généré", "*NODE", "a.b", "x" * 80])
def test_the_name_of_a_set_reads_back_the_same(tmp_path: Path, name: str) -> None:
    mesh = fedic.rectangle_mesh((0, 0, 2, 1), 1.0).with_sets({name: MeshSet(cells=[1])})
    assert written(mesh, tmp_path / "mesh.inp").sets == mesh.sets


@pytest.mark.parametrize("name", ['a"b', "a\nb", " a", "x" * 81, "a\0"])
def test_names_that_abaqus_does_not_allow_are_refused(tmp_path: Path, name: str) -> None:
    mesh = fedic.rectangle_mesh((0, 0, 2, 1), 1.0).with_sets({name: MeshSet(nodes=[1])})
    with pytest.raises(fedic.MeshError, match=r"mesh\.inp: the set .* cannot be written: a name in Abaqus has"):
        mesh.write(tmp_path / "mesh.inp")
    assert not list(tmp_path.iterdir())
