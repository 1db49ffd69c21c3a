"""Noise of the displacement over the Cramer-Rao bound in cells of any shape, by Monte Carlo with a fixed seed."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic

SHAPE = (230, 230)
NOISE = 1.0
DRAWS = 60
PLAIN: dict[str, Any] = {"smoothing": 0.0, "num_threads": 1}
FINE = fedic.MeshQuadrature(density=9.0)
"""Enough points for the integrals of the bound."""


def texture() -> NDArray[np.float64]:
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    points = np.stack([u, v], axis=-1).reshape(-1, 2).astype(float)
    grey: NDArray[np.float64] = 35 + 180 * fedic.synthetic.Speckle(5.0, seed=3).values(points).reshape(SHAPE)
    return grey


def tapered(ratio: float) -> fedic.Mesh:
    """Return trapezia whose parallel edges have lengths in the given ratio, wide and narrow ones alternating."""
    wide = 60.0 * ratio / (1.0 + ratio)
    x = [np.concatenate([[0.0], np.cumsum([[wide, 60.0 - wide][(k + row) % 2] for k in range(6)])]) for row in range(5)]
    points = [(25.0 + u, 25.0 + 44.0 * row) for row in range(5) for u in x[row]]
    return fedic.Mesh(np.array(points), {"quad": _grid(6, 4)})


def elongated(ratio: float, cell: str) -> fedic.Mesh:
    """Return cells of 256 square pixels, longer than high by the given ratio, turned by 20 degrees."""
    square = fedic.rectangle_mesh((0.0, 0.0, round(8 / np.sqrt(ratio)), round(8 * np.sqrt(ratio) * 0.7)), 1.0, cell)
    stretched = square.points * (16.0 * np.sqrt(ratio), 16.0 / np.sqrt(ratio))
    centred = fedic.Mesh(stretched - stretched.mean(axis=0), square.cells)
    return centred.rotated([0.0, 0.0, np.radians(20.0)]).translated((114.6, 115.3))


def ring(cell: str) -> fedic.Mesh:
    """Return cells with curved edges between circles of 10 and 100 px."""
    flat = fedic.rectangle_mesh((0.0, 0.0, 8.0, 2.0), 1.0, cell)
    turn, out = flat.points.T
    radius = 10.0 + 22.5 * out * (1.0 + out / 2.0) + 1e-9
    angle = 2.0 * np.pi * turn / 8.5
    points = np.column_stack([114.3 + radius * np.cos(angle), 115.2 + radius * np.sin(angle)])
    return fedic.Mesh(points, flat.cells)


def _grid(columns: int, rows: int) -> list[list[int]]:
    first = [row * (columns + 1) + column for row in range(rows) for column in range(columns)]
    return [[k, k + 1, k + columns + 2, k + columns + 1] for k in first]


def noise_over_bound(mesh: fedic.Mesh) -> float:
    clean = texture()
    bound = fedic.Correlator(clean.astype(np.float32), mesh, quadrature=FINE, **PLAIN).standard_deviations(NOISE)
    rng = np.random.default_rng(11)
    errors = []
    for _ in range(DRAWS):
        reference, deformed = (clean + rng.normal(0.0, NOISE, (2, *SHAPE))).astype(np.float32)
        errors.append(fedic.correlate(reference, deformed, mesh, **PLAIN).displacement)
    return float(np.sqrt(np.mean(np.square(errors) / bound**2)))


def points_per_pixel(mesh: fedic.Mesh) -> float:
    correlator = fedic.Correlator(texture().astype(np.float32), mesh, **PLAIN)
    return correlator.num_points / float(mesh.areas().sum())


CASES: dict[str, Callable[[], fedic.Mesh]] = {
    "tapered 1:1": lambda: tapered(1.0),
    "tapered 2:1": lambda: tapered(2.0),
    "tapered 4:1": lambda: tapered(4.0),
    "tapered 8:1": lambda: tapered(8.0),
    "elongated quads 8:1": lambda: elongated(8.0, "quad"),
    "triangles": lambda: elongated(1.0, "triangle"),
    "elongated triangles 8:1": lambda: elongated(8.0, "triangle"),
    "elongated triangles of 6 nodes": lambda: elongated(3.0, "triangle6"),
    "ring of triangles of 6 nodes": lambda: ring("triangle6"),
    "ring of quads": lambda: ring("quad"),
    "ring of quads of 8 nodes": lambda: ring("quad8"),
    "ring of quads of 9 nodes": lambda: ring("quad9"),
}


@pytest.mark.parametrize("case", CASES)
def test_noise_is_within_three_percent_of_the_bound(case: str) -> None:
    assert noise_over_bound(CASES[case]()) <= 1.03


@pytest.mark.parametrize("case", CASES)
def test_points_are_about_one_per_pixel(case: str) -> None:
    assert 0.8 < points_per_pixel(CASES[case]()) < 1.6
