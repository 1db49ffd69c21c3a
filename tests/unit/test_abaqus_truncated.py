"""Abaqus files that end within a part, an instance or the assembly."""

from pathlib import Path

import pytest

import fedic

PART = (
    "*PART, NAME=P\n*NODE\n1, 0., 0.\n2, 1., 0.\n3, 1., 1.\n4, 0., 1.\n*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n*END PART\n"
)
INSTANCES = "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*INSTANCE, NAME=J, PART=P\n3., 0.\n"
WHOLE = f"{PART}{INSTANCES}*END INSTANCE\n*END ASSEMBLY\n"


@pytest.mark.parametrize(
    ("end", "message"),
    [
        ("*END PART", r"line 1: \*PART has no \*END PART"),
        ("*END INSTANCE\n*INSTANCE", r"line 11: \*INSTANCE has no \*END INSTANCE"),
        ("*INSTANCE, NAME=J", r"line 10: \*ASSEMBLY has no \*END ASSEMBLY"),
        ("*END ASSEMBLY", r"line 10: \*ASSEMBLY has no \*END ASSEMBLY"),
    ],
)
def test_a_file_that_ends_too_early_is_refused(tmp_path: Path, end: str, message: str) -> None:
    path = tmp_path / "plate.inp"
    path.write_text(WHOLE[: WHOLE.index(end)])
    with pytest.raises(fedic.MeshError, match=message):
        fedic.read_mesh(path)


def test_the_whole_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "plate.inp"
    path.write_text(WHOLE)
    assert fedic.read_mesh(path).num_cells == 2
