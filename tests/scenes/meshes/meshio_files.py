"""Files in the formats that meshio reads, written by meshio."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from scenes.meshes.plate import MIXED_QUADS, POINTS, QUADS, TRIANGLES

__all__ = ["FILES", "write_two_zones"]


def _quads(path: Path) -> None:
    import meshio

    meshio.write(path, meshio.Mesh(POINTS, [("quad", QUADS)]))


def _mixed(path: Path) -> None:
    import meshio

    meshio.write(path, meshio.Mesh(POINTS, [("quad", MIXED_QUADS), ("triangle", TRIANGLES)]))


def _triangles(path: Path) -> None:
    import meshio

    halves = [half for a, b, c, d in QUADS.tolist() for half in ((a, b, c), (a, c, d))]
    meshio.write(path, meshio.Mesh(POINTS, [("triangle", np.array(halves))]))


_MIXED, _TRIANGLES = {"quad": 4, "triangle": 4}, {"triangle": 12}
FILES: list[tuple[str, str, Callable[[Path], None], dict[str, int]]] = [
    ("AVS-UCD .avs", ".avs", _mixed, _MIXED),
    ("DOLFIN .xml", ".xml", _triangles, _TRIANGLES),
    ("Medit .mesh", ".mesh", _mixed, _MIXED),
    ("Medit .meshb", ".meshb", _mixed, _MIXED),
    ("Netgen .vol", ".vol", _mixed, _MIXED),
    ("OBJ .obj", ".obj", _mixed, _MIXED),
    ("OFF .off", ".off", _triangles, _TRIANGLES),
    ("PLY .ply", ".ply", _mixed, _MIXED),
    ("STL .stl", ".stl", _triangles, _TRIANGLES),
    ("Tecplot .dat", ".dat", _quads, {"quad": 6}),
    ("Tecplot .tec", ".tec", _quads, {"quad": 6}),
]
"""Name, suffix, writer, and number of cells of each type."""


def write_two_zones(path: Path) -> None:
    _quads(path)
    lines = path.read_text().splitlines()
    zone = next(index for index, line in enumerate(lines) if line.startswith("ZONE"))
    path.write_text("\n".join([*lines, *lines[zone:]]) + "\n")
