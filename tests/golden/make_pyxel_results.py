"""Measure the stored images with pyxel-dic and store its nodal displacements.

Run it in an environment of its own: pip install pyxel-dic==2026.10.8
"""

from importlib.metadata import version
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
import pyxel  # type: ignore[import-not-found]

FOLDER = Path(__file__).parent
REGION = np.array([[45.3, 36.6], [155.3, 124.6]])
SIZE = 22.0
TYPES = {"quad": 3, "triangle": 2, "triangle6": 9, "quad8": 16, "quad9": 10}
"""Numbers that gmsh gives the cell types."""


def measure(cell: str) -> dict[str, np.ndarray]:
    """Return nodes (u, v), cells and the displacement of the nodes in pixels, v downwards."""
    images = [pyxel.Image(str(FOLDER / "images" / f"{name}.png")).Load() for name in ("reference", "deformed")]
    mesh, camera = pyxel.MeshFromROI(REGION, SIZE, typel=TYPES[cell])
    mesh.Connectivity()
    mesh.DICIntegration(camera)
    unknowns, _ = pyxel.Correlate(
        *images, mesh, camera, U0=np.zeros(mesh.ndof), eps=1e-8, maxiter=100, disp=False, direct=True
    )
    x, y = mesh.n.T
    along_x, along_y = unknowns[mesh.conn].T
    points = np.column_stack(camera.P(x, y))
    moved = np.column_stack(camera.P(x + along_x, y + along_y))
    return {"points": points, "cells": mesh.e[TYPES[cell]], "displacement": moved - points}


def main() -> None:
    """Measure with all cell types."""
    found = {f"{cell}:{key}": value for cell in TYPES for key, value in measure(cell).items()}
    np.savez_compressed(FOLDER / "pyxel_results.npz", version=np.array(version("pyxel-dic")), **found)


if __name__ == "__main__":
    main()
