"""Limits on what a small mesh file may make fedic do."""

from pathlib import Path

import numpy as np
import pytest

import fedic
from fedic.io.mesh_formats.abaqus import container, reader

NODES = "*NODE\n1, 0., 0.\n2, 1., 0.\n3, 1., 1.\n4, 0., 1.\n"
SQUARE = f"{NODES}*ELEMENT, TYPE=CPS4, ELSET=S0\n1, 1, 2, 3, 4\n"
MANY = "999999999999999999"


def read(tmp_path: Path, text: str, name: str = "mesh.inp") -> fedic.Mesh:
    (tmp_path / name).write_text(text)
    return fedic.read_mesh(tmp_path / name)


def test_sets_that_hold_sets_twice_are_resolved_once(tmp_path: Path) -> None:
    sets = "".join(f"*ELSET, ELSET=S{level}\nS{level - 1}, S{level - 1}\n" for level in range(1, 60))
    assert read(tmp_path, SQUARE + sets).sets["S59"].cells.tolist() == [0]


def test_sets_in_a_long_chain_are_refused(tmp_path: Path) -> None:
    sets = "".join(f"*ELSET, ELSET=S{level}\nS{level - 1},\n" for level in range(3000, 0, -1))
    with pytest.raises(fedic.MeshError, match="sets contain each other over more than 100 levels"):
        read(tmp_path, SQUARE + sets)


def test_a_range_of_a_set_may_be_wider_than_the_mesh(tmp_path: Path) -> None:
    mesh = read(tmp_path, f"{SQUARE}*NSET, NSET=ALL, GENERATE\n1, {MANY}\n*NSET, NSET=ODD, GENERATE\n1, {MANY}, 2\n")
    assert mesh.sets["ALL"].nodes.tolist() == [0, 1, 2, 3]
    assert mesh.sets["ODD"].nodes.tolist() == [0, 2]


def test_what_all_keywords_generate_is_limited_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(container.Budget, "__init__", lambda self: setattr(self, "left", 1000))
    row = "*NGEN\n1, 2001, 10\n"
    nodes = NODES.replace("2, 1.", "2001, 1.")
    text = f"{nodes}*ELEMENT, TYPE=CPS4\n1, 1, 2001, 3, 4\n"
    assert read(tmp_path, text + row * 5).num_cells == 1
    with pytest.raises(fedic.MeshError, match=r"line 19: not a valid line of \*NGEN \(with 199 more, over"):
        read(tmp_path, text + row * 6)


def test_the_size_of_all_instances_is_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reader, "MAX_SIZE", 50)
    instances = "".join(f"*INSTANCE, NAME=I{index}, PART=P\n*END INSTANCE\n" for index in range(11))
    with pytest.raises(fedic.MeshError, match="the instances have 55 nodes and elements, more than 50"):
        read(tmp_path, f"*PART, NAME=P\n{SQUARE}*END PART\n*ASSEMBLY, NAME=A\n{instances}*END ASSEMBLY\n")


def test_coordinate_systems_in_a_long_chain_are_refused(tmp_path: Path) -> None:
    systems = "".join(f"CORD2R,{n},{n + 1},0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n" for n in range(1, 3000))
    with pytest.raises(fedic.MeshError, match="more than 100 coordinate systems depend on each other"):
        read(tmp_path, f"{systems}CORD2R,3000,0,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,1,0.,0.\n", "mesh.bdf")


def test_components_may_name_ranges_wider_than_the_mesh(tmp_path: Path) -> None:
    text = "/PREP7\nET,1,182\nN,1,0,0\nN,2,1,0\nN,3,1,1\nN,4,0,1\nE,1,2,3,4\nCMBLOCK,ALL,NODE,2\n(8i20)\n"
    mesh = read(tmp_path, f"{text}{1:20d}{'-' + MANY:>20}\n", "mesh.cdb")
    np.testing.assert_array_equal(mesh.sets["ALL"].nodes, [0, 1, 2, 3])


@pytest.mark.parametrize("suffix", [".inp", ".bdf", ".cdb", ".unv", ".dat"])
@pytest.mark.parametrize(
    "text", ["", "\n\n", "\0", "-1\n" * 50, "*" * 5000, "," * 5000, "(" * 5000, "NBLOCK,\n(9" * 500]
)
def test_files_that_are_no_mesh_are_refused(tmp_path: Path, suffix: str, text: str) -> None:
    with pytest.raises(fedic.MeshError, match=rf"mesh\{suffix}"):
        read(tmp_path, text, f"mesh{suffix}")
