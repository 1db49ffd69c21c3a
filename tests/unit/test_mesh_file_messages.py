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
