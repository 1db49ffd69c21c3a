"""Small Abaqus models of parts and instances."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats.abaqus import read_abaqus

__all__ = ["PIN", "PLATE", "SOLID", "assembly", "contents", "instance", "surface_points"]

PLATE = """\
*Part, name=Plate
*Node
10, 0., 0., 0.
20, 2., 0., 0.
30, 2., 1., 0.
40, 0., 1., 0.
*Element, type=CPS4R, elset=Body
1, 10, 20, 30, 40
*Nset, nset=Left
10, 40
*End Part
"""
PIN = """\
*Part, name=Pin
*Node
1, 5., 5., 1.
2, 6., 5., 1.
3, 6., 6., -1.
4, 5., 6., -1.
*Element, type=R3D4, elset=Skin
1, 1, 2, 3, 4
*End Part
"""
SOLID = """\
*Part, name=Block
*Node
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 2., 0., 0.
10, 2., 1., 0.
11, 2., 0., 1.
12, 2., 1., 1.
*Element, type=C3D8R, elset=Body
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 2, 9, 10, 3, 6, 11, 12, 7
*Elset, elset=Both, generate
1, 2
*Surface, name=Front, type=ELEMENT
Both, S2
*Surface, name=Skin
Body,
*Surface, name=End
2, S4
*End Part
"""


def instance(name: str, part: str, *lines: str) -> str:
    return "\n".join([f"*Instance, name={name}, part={part}", *lines, "*End Instance\n"])


def assembly(*instances: str) -> str:
    return f"*Assembly, name=Assembly\n{''.join(instances)}*End Assembly\n"


def contents(tmp_path: Path, text: str) -> MeshFile:
    (tmp_path / "model.inp").write_text(text)
    return read_abaqus(tmp_path / "model.inp")


def surface_points(file: MeshFile, name: str) -> NDArray[np.float64]:
    return np.concatenate([file.points[nodes].reshape(-1, 3) for _, nodes in file.surfaces[name]])
