"""Messages about mesh files that hold nothing, or that meshio refuses, say what to do."""

from pathlib import Path

import pytest

import fedic


@pytest.mark.parametrize("suffix", ["inp", "msh", "vtk", "vtu", "stl", "med", "bdf", "unv"])
def test_an_empty_file_is_called_empty(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"plate.{suffix}"
    path.write_bytes(b"")
    with pytest.raises(fedic.MeshError, match="the mesh file is empty"):
        fedic.read_mesh(path)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("plate.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        ("plate.ply", "hello\n"),
        ("plate.mesh", "MeshVersionFormatted 2\nDimension 3\nhello\n"),
        ("plate.vol", "hello\n"),
    ],
)
def test_what_meshio_refuses_is_said_with_another_format(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(fedic.MeshError, match=r"cannot be read \(.*\)\. Save the mesh as VTK") as caught:
        fedic.read_mesh(tmp_path / name)
    assert "Error" not in str(caught.value)
    assert "Couldn't read file" not in str(caught.value)


def test_a_file_without_nodes_says_so(tmp_path: Path) -> None:
    path = tmp_path / "plate.stl"
    path.write_text("solid plate\nendsolid plate\n")
    with pytest.raises(fedic.MeshError, match="it holds no nodes"):
        fedic.read_mesh(path)


def test_surface_cells_that_are_not_there_are_not_listed(tmp_path: Path) -> None:
    path = tmp_path / "points.off"
    path.write_text("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n")
    with pytest.raises(fedic.MeshError, match="cells found: none"):
        fedic.read_mesh(path)


def test_a_group_of_gmsh_without_elements_is_not_said_to_be_missing(tmp_path: Path) -> None:
    path = tmp_path / "plate.msh"
    path.write_text(
        '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 "PLATE"\n$EndPhysicalNames\n'
        "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 2 0 1 1 2 3\n$EndElements\n"
    )
    assert fedic.read_mesh(path).sets == {}
    with pytest.raises(fedic.MeshError, match="'PLATE' chooses no surface cell"):
        fedic.read_mesh(f"{path}#PLATE")


@pytest.mark.parametrize("name", ["plate.stl", "plate.xdmf"])
def test_a_folder_that_cannot_be_listed_is_no_obstacle(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    mesh = fedic.Mesh([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)], {"triangle": [(0, 1, 2)]}, {})
    mesh.write(tmp_path / name)

    def refuse(_: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refuse)
    assert fedic.read_mesh(tmp_path / name).num_cells == 1
