"""Bulk data of Nastran and OptiStruct."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fedic
from fedic.io.mesh_formats import mesh_reader
from fedic.io.mesh_parts import SOLIDS, faces_of

POINTS = [[0, 0], [10, 0], [10, 10], [0, 10], [20, 0], [20, 10]]
SMALL = "".join(f"GRID    {i:<8}        {x:<8}{y:<8}0.\n" for i, (x, y) in enumerate(POINTS, 1))
QUADS = (
    "CQUAD4  1       7       1       2       3       4\nCQUAD4  2       7       2       5       6       3       30.0\n"
)
LONG = "".join(f"GRID*   {i:<16}{'':<16}{x:<16}{y:<16}*A\n*A      0.\n" for i, (x, y) in enumerate(POINTS, 1))
FREE = "".join(f"GRID,{i},,{x}.,{y}.+0,0.\n" for i, (x, y) in enumerate(POINTS, 1))


def read(tmp_path: Path, text: str, name: str = "plate.bdf") -> fedic.Mesh:
    (tmp_path / name).write_bytes(text.encode("latin-1"))
    return fedic.read_mesh(tmp_path / name)


def assert_two_cells(mesh: fedic.Mesh) -> None:
    np.testing.assert_array_equal(mesh.points, POINTS)
    np.testing.assert_array_equal(mesh.cells["quad"], [[0, 1, 2, 3], [1, 4, 5, 2]])
    assert mesh.sets["PID 7"].cells.tolist() == [0, 1]


@pytest.mark.parametrize(
    "text",
    [
        f"SOL 101\nCEND\nTITLE = GRID, none\nBEGIN BULK\n{SMALL}{QUADS}ENDDATA\nGRID,1,,9.,9.\n",
        f"$ written by a program\n{SMALL}{QUADS}ENDDATA\n",
        f"begin bulk $ here\n{QUADS}{SMALL}".lower(),
        f"BEGIN BULK\n{LONG}{QUADS}ENDDATA",
        f"BEGIN BULK\n{FREE}{QUADS}ENDDATA",
        f"BEGIN BULK\n{SMALL}{QUADS}ENDDATA".replace("\n", "\r\n"),
        f"BEGIN BULK\n{SMALL}CQUAD4,1,7,1,2,3,4\nCQUAD4,2,7,2,5,6,3,30.\nENDDATA",
        f"BEGIN BULK\n{SMALL}CQUAD4\t1\t7\t1\t2\t3\t4\nCQUADR  2       7       2       5       6       3       5\n",
        f"BEGIN BULK\n{SMALL}{QUADS}CBUSH,9,1,1,2\nRBE2,8,1,123,2,3\nCQUAD4,2,7,2,5,6,3,30.0\n{SMALL}ENDDATA",
        f"BEGIN BULK\n{SMALL}{QUADS}PBARL,9,1,,,,,,,,,,5.\nMAT9,1,2,+X\n+Y,3\n",
        f"BEGIN BULK\n{SMALL}{QUADS}PSHELL,7,1,1.5-3\nMAT1,1,7.+10,,.3 $ \xe9paisseur\nENDDATA",
    ],
)
def test_files_of_many_programs_are_read(tmp_path: Path, text: str) -> None:
    for name in ("plate.bdf", "plate.nas", "plate.fem", "plate.dat"):
        assert_two_cells(read(tmp_path, text, name))


def test_included_files_are_read(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "the nodes.bdf").write_text(SMALL)
    assert_two_cells(read(tmp_path, f"BEGIN BULK\ninclude 'sub\\the nodes.bdf'\n{QUADS}"))
    os.mkfifo(tmp_path / "pipe")
    for name, message in (("none", "does not exist"), ("pipe", "no regular file"), ("plate.bdf", "includes itself")):
        with pytest.raises(fedic.MeshError, match=rf"plate\.bdf, line 2: .*{message}"):
            read(tmp_path, f"BEGIN BULK\nINCLUDE '{name}'\n{QUADS}")


SYSTEMS = {
    "CORD2C,5,,100.,0.,0.,100.,0.,1.\n,101.,0.,0.\n": [[101, 0], [102, 0], [100, 2], [100, 1]],
    "CORD2C,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n": [[0, 1], [0, 2], [-2, 0], [-1, 0]],
    "CORD2C,5,6,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,6,0,5.,6.,0.,5.,6.,1.\n,5.,7.,0.\n": [
        [5, 7],
        [5, 8],
        [3, 6],
        [4, 6],
    ],
    "CORD1C,5,11,12,13\nGRID,11,0,3.,0.,0.\nGRID,12,0,3.,0.,2.\nGRID,13,0,9.,0.,0.\n": [[4, 0], [5, 0], [3, 2], [3, 1]],
    "CORD2S,5,,0.,0.,0.,0.,-1.,0.\n,1.,0.,0.\n": [[0, -1], [0, -2], [2, 0], [1, 0]],
}


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("default", [True, False])
def test_nodes_in_other_systems_are_read(tmp_path: Path, system: str, default: bool) -> None:
    number = "" if default else "5"
    polar = [(1, 0), (2, 0), (2, 90), (1, 90)]
    grids = "".join(f"GRID,{i},{number},{r}.,{angle}.\n" for i, (r, angle) in enumerate(polar, 1))
    system += "GRDSET,,5\n" if default else ""
    mesh = read(tmp_path, f"{grids}CQUAD4,1,1,1,2,3,4\n{system}ENDDATA\n")
    np.testing.assert_allclose(mesh.points[:4, :2], SYSTEMS[system.replace("GRDSET,,5\n", "")], atol=1e-12)


EIGHT = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]]


@pytest.mark.parametrize(
    ("card", "cell", "nodes"),
    [
        ("CTRIA3,1,1,1,2,3,30.", "triangle", [0, 1, 2]),
        ("CTRIAR,1,1,1,2,3", "triangle", [0, 1, 2]),
        ("CPLSTN4,1,1,1,2,3,4", "quad", [0, 1, 2, 3]),
        ("CSHEAR,1,1,1,2,3,4", "quad", [0, 1, 2, 3]),
        ("CQUAD8  1       1       1       2       3       4       5       6\n        7       8", "quad8", [*range(8)]),
        ("CQUAD8,1,1,1,2,3,4,5,6,+X\n+X,7,8,.1,.1,.1,.1,30.", "quad8", [*range(8)]),
        ("CQUAD8,1,1,1,2,3,4", "quad", [0, 1, 2, 3]),
        ("CQUAD8,1,1,1,2,3,4,0,0\n,0,0", "quad", [0, 1, 2, 3]),
        ("CQUAD,1,1,1,2,3,4,5,6\n,7,8", "quad8", [*range(8)]),
        ("CTRIA6,1,1,1,2,4,5,9,8\n,5", "triangle6", [0, 1, 3, 4, 8, 7]),
        ("CTRIAX6,1,1,1,5,2,9,4,8", "triangle6", [0, 1, 3, 4, 8, 7]),
    ],
)
def test_surface_elements_are_read(tmp_path: Path, card: str, cell: str, nodes: list[int]) -> None:
    grids = "".join(f"GRID,{i},,{x}.,{y}.\n" for i, (x, y) in enumerate([*EIGHT, [1, 1]], 1))
    mesh = read(tmp_path, f"BEGIN BULK\n{grids}{card}\nENDDATA")
    assert {name: each.tolist() for name, each in mesh.cells.items()} == {cell: [nodes]}


def test_middle_nodes_of_solids_lie_on_their_edges(tmp_path: Path, gmsh: Any) -> None:
    gmsh.initialize([], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.addRectangle(5, 0, 0, 1, 1)
        gmsh.model.occ.extrude([(2, 7)], 0, 0, 1, [1], recombine=True)
        gmsh.model.occ.addBox(9, 0, 0, 1, 1, 1)
        gmsh.model.occ.synchronize()
        for surface in (s for _, s in gmsh.model.getEntities(2) if gmsh.model.getBoundingBox(2, s)[0] > 8):
            gmsh.model.mesh.setTransfiniteSurface(surface)
            gmsh.model.mesh.setRecombine(2, surface)
        gmsh.model.mesh.setTransfiniteVolume(3)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        names = [str(tmp_path / f"solids{suffix}") for suffix in (".bdf", ".unv", ".inp")]
        for name in names:
            gmsh.write(name)
    finally:
        gmsh.finalize()
    for name in names:
        file = mesh_reader(Path(name))(Path(name))
        solids = {cell: nodes for cell, nodes in file.blocks if cell in SOLIDS}
        assert set(solids) == {"tetra10", "wedge15", "hexahedron20"}
        for cell, nodes in solids.items():
            for _, places in faces_of(cell):
                corners, middle = np.split(file.points[nodes[:, places]], 2, axis=1)
                np.testing.assert_allclose(middle, (corners + np.roll(corners, -1, axis=1)) / 2, atol=1e-5)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("CQUAD8,1,1,1,2,3,4,5", "line 7: the CQUAD8 element 1 lacks the nodes 6, 7, 8 of 8"),
        ("CQUAD4,1,1,1,2,3", "line 7: the CQUAD4 element 1 lacks the nodes 4 of 4"),
        ("CQUAD4,1,1,1,2,3,X", "line 7: not a valid CQUAD4 card .field 7: 'X' is not a whole number"),
        ("CQUAD4,1,1,1,2,3,99", "element 1 refers to node 99"),
        ("CTRIA3,1,1,1,2,3\nCTRIA3,1,1,1,2,4", "line 8: CTRIA3 1 is defined a second time, not as in line 7"),
        ("GRID,1,,5.,5.", "line 7: GRID 1 is defined a second time, not as in line 1"),
        ("GRID,9,77,5.,5.", "line 7: the coordinate system 77 is not defined"),
        ("GRID,9,,5.,5.x", "line 7: not a valid GRID card .field 5: '5.x' is not a number"),
        ("GRID,9,3,5.,5.\nCORD2R,3,3,0.,0.,0.,0.,0.,1.\n,1.,0.,0.", "the coordinate system 3 depends on itself"),
        ("GRID,9,3,5.,5.\nCORD1R,3,9,1,2", "the coordinate system 3 depends on itself"),
        ("GRID,9,3,5.,5.\nCORD1R,3,1,2,88", "CORD1R refers to node 88"),
        ("GRID,9,3,5.,5.\nCORD2R,3,,0.,0.,0.,0.,0.,1.\n,0.,0.,5.", "points of the coordinate system lie on one line"),
        ("CQUAD8,1,1,1,2,3,4,5,6,+A\n+B,1,2", "line 7: the lines of the card do not follow each other"),
        ("CHEXA,1,1,1,2,3,4,5,6,1,2", "line 7: more than 10 fields"),
        ("GRID,99999999999999999999,,1.", "line 7: .*too large a number"),
        ("BEGIN SUPER=1\nGRID,1", "line 7: superelements and modules are not read"),
    ],
)
def test_cards_that_are_not_understood_are_refused_by_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(fedic.MeshError, match=message):
        read(tmp_path, f"{SMALL}{text}\n")


def test_a_continuation_of_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(fedic.MeshError, match="line 1: this continuation line belongs to no card"):
        read(tmp_path, "+A,1,2\n")


def test_elements_given_by_two_numbers_are_one_cell_of_both_sets(tmp_path: Path) -> None:
    mesh = read(tmp_path, f"{SMALL}{QUADS}CQUAD4,3,8,2,5,6,3\nCBAR,9,3,1,2,0.,0.,1.\n")
    assert mesh.num_cells == 2
    assert {name: each.cells.tolist() for name, each in mesh.sets.items()} == {"PID 7": [0, 1], "PID 8": [1]}
