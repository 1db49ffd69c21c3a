"""The table of the mesh files of finite element programs: each file gives the plate that it holds, or is refused."""

from collections.abc import Callable
from pathlib import Path

import pytest

from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats import mesh_reader
from fedic.io.mesh_formats.abaqus import read_abaqus
from fedic.io.mesh_formats.ansys import read_ansys
from fedic.io.mesh_formats.nastran import read_nastran
from fedic.io.mesh_formats.vtk import read_xml_vtk
from scenes.finite_element_files import FILES, FiniteElementFile, outcome


@pytest.mark.parametrize("file", FILES, ids=lambda file: f"{file.program}-{file.variant}")
def test_each_file_is_read_or_refused_as_the_table_says(tmp_path: Path, file: FiniteElementFile) -> None:
    assert outcome(file, tmp_path).startswith("refused: " if file.refused else "read")


@pytest.mark.parametrize(
    ("name", "text", "reader"),
    [
        ("a.inp", "** a comment\n*Heading\n/COM, a title\n", read_abaqus),
        ("a.inp", "! a comment\n\n/batch\n*SET,a,1\n", read_ansys),
        ("a.inp", "nothing that is known\n", read_abaqus),
        ("a.dat", "$ a comment\nSOL 101\n", read_nastran),
        ("a.dat", "GRID*   1\n", read_nastran),
        ("a.dat", "/com, a title\n*HEADING\n", read_ansys),
        ("a.dat", "*PART, NAME=P\n", read_abaqus),
        ("a.dat", 'TITLE = "a"\nVARIABLES = "X", "Y"\nZONE T="N, 1"\n', mesh_reader(Path("a.tec"))),
        ("a.dat", "\0\1\2\3", mesh_reader(Path("a.tec"))),
        ("a.CDB", "", read_ansys),
        ("a.vtu", "*NODE\n", read_xml_vtk),
    ],
)
def test_the_program_is_told_by_the_contents(
    tmp_path: Path, name: str, text: str, reader: Callable[[Path], MeshFile]
) -> None:
    (tmp_path / name).write_text(text)
    found = mesh_reader(tmp_path / name)
    assert found is reader or found.__name__ == reader.__name__
