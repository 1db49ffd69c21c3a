"""Agreement with pyxel-dic, another finite element code, on the stored images."""

import numpy as np
import pytest

import fedic
from golden.cases import CELLS, FOLDER, image

SAME_POINTS = ("quad", "quad8", "quad9")
"""Cells whose quadrature points are the same in both programs; the subdivisions of triangles differ."""
TOLERANCE = {True: 4e-5, False: 8e-3}
"""Pixels; measured at most 1.6e-5 with equal quadrature points, 5.3e-3 otherwise."""


@pytest.mark.parametrize("cell", CELLS)
def test_displacement_agrees_with_pyxel(cell: str) -> None:
    with np.load(FOLDER / "pyxel_results.npz", allow_pickle=False) as stored:
        points, cells, expected = (stored[f"{cell}:{key}"] for key in ("points", "cells", "displacement"))
    mesh = fedic.Mesh(points, {cell: cells})
    result = fedic.correlate(
        image("reference"),
        image("deformed"),
        mesh,
        interpolation="bspline3",
        smoothing=0.0,
        quadrature=fedic.MeshQuadrature(rule="edges"),
        tolerance=1e-6,
    )
    assert result.converged
    difference = np.linalg.norm(result.displacement - expected, axis=1)[mesh.used_nodes]
    assert difference.max() < TOLERANCE[cell in SAME_POINTS]
