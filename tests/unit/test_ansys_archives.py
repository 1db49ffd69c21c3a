"""Lines that CDWRITE adds to an archive of Ansys, and that make no node and no element."""

from pathlib import Path

import numpy as np
import pytest

import fedic

NODES = (
    "NBLOCK,6,SOLID,4,4\n(3i9,6e21.13e3)\n"
    + "".join(
        f"{number:9d}{0:9d}{0:9d}{x:21.13E}{y:21.13E}\n"
        for number, (x, y) in enumerate([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)], 1)
    )
    + "N,R5.3,LOC,       -1,\n"
)
ELEMENT = (
    "EBLOCK,19,SOLID,1,1\n(19i8)\n"
    + "".join(f"{number:8d}" for number in (1, 1, 1, 1, 0, 0, 0, 0, 4, 0, 1, 1, 2, 3, 4))
    + "\n      -1\n"
)


@pytest.mark.parametrize(
    "lines",
    [
        "EN,R5.5,ATTR,       -1,\n",
        "en,r5.5,attr,-1\n",
        "EXTOPT,ATTR,      0,      0,      0\nEXTOPT,ESIZE,  0,  0.0000\nEXTOPT,ACLEAR,      0\n",
        "EN,R5.5,ATTR,       -1,\nEXTOPT,ATTR,      0,      0,      0\nBFUNIF,TEMP,_TINY\n",
    ],
)
def test_ends_and_options_of_an_archive_make_nothing(tmp_path: Path, lines: str) -> None:
    path = tmp_path / "plate.cdb"
    path.write_text(f"/PREP7\nET,1,181\n{NODES}{ELEMENT}{lines}/GO\nFINISH\n")
    mesh = fedic.read_mesh(path)
    np.testing.assert_array_equal(mesh.cells["quad"], [[0, 1, 2, 3]])
    assert mesh.areas().sum() == 100.0
