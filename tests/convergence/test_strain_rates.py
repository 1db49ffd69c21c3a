"""Observed rates of convergence of finite strains under a large deformation, from exact displacements of the nodes.

The deformation is a wave of 10 % strain followed by a rotation of 70 degrees, on a mesh mapped so that its cells are
not parallelograms. The error of cells of degree p is of order p: strains are derivatives.
"""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic

Floats = NDArray[np.float64]

SIZES = (0.1, 0.05, 0.025)
DEGREES = {"triangle": 1, "quad": 1, "triangle6": 2, "quad8": 2, "quad9": 2}
ROTATION = np.array([[np.cos(1.22), -np.sin(1.22)], [np.sin(1.22), np.cos(1.22)]])


def mapped(points: Floats) -> Floats:
    """Return the points of a sheared and curved square."""
    x, y = points.T
    return np.column_stack([x + 0.2 * y + 0.05 * np.sin(3.0 * y), y + 0.05 * np.sin(3.0 * x)])


def displacement(points: Floats) -> Floats:
    x, y = points.T
    moved = np.column_stack([x + 0.03 * np.sin(3.0 * x + y), y - 0.02 * np.cos(4.0 * y - x)])
    return np.asarray(moved @ ROTATION.T - points)


def deformation_gradients(points: Floats) -> Floats:
    x, y = points.T
    a, b = 0.03 * np.cos(3.0 * x + y), 0.02 * np.sin(4.0 * y - x)
    stretched = np.array([[1.0 + 3.0 * a, a], [-b, 1.0 + 4.0 * b]])
    return np.einsum("ab,bcn->nac", ROTATION, stretched)


def green_lagrange(points: Floats) -> Floats:
    gradients = deformation_gradients(points)
    return 0.5 * (np.einsum("nba,nbc->nac", gradients, gradients) - np.eye(2))


def hencky(points: Floats) -> Floats:
    squares, vectors = np.linalg.eigh(2.0 * green_lagrange(points) + np.eye(2))
    return np.einsum("nak,nk,nbk->nab", vectors, 0.5 * np.log(squares), vectors)


EXACT: dict[str, Callable[[Floats], Floats]] = {"green-lagrange": green_lagrange, "hencky": hencky}


def errors(cell: str, measure: str) -> dict[str, list[float]]:
    inside = mapped(np.random.default_rng(0).uniform(0.05, 0.95, (5000, 2)))
    found: dict[str, list[float]] = {"cells": [], "nodes": [], "boundary nodes": [], "points": []}
    for size in SIZES:
        square = fedic.rectangle_mesh((0.0, 0.0, 1.0, 1.0), size, cell)
        mesh = fedic.Mesh(mapped(square.points), square.cells)
        nodal = displacement(mesh.points)
        boundary = (np.abs(square.points - 0.5) > 0.5 - 1e-9).any(axis=1)
        for name, at in (("cells", "cells"), ("nodes", "nodes"), ("boundary nodes", "nodes"), ("points", inside)):
            strains = mesh.strains(nodal, measure, at)  # type: ignore[arg-type]
            differences = strains.values - EXACT[measure](strains.positions)
            if name == "boundary nodes":
                differences = differences[boundary]
            found[name].append(float(np.sqrt(np.mean(differences**2))))
    return found


@pytest.mark.parametrize("measure", EXACT)
@pytest.mark.parametrize("cell", DEGREES)
def test_finite_strains_converge_at_the_theoretical_rates(cell: str, measure: str) -> None:
    """Measured orders of Green-Lagrange strains; those of Hencky strains differ by 0.01.

    ==============  ========  ====  =========  =====  =====
    positions       triangle  quad  triangle6  quad8  quad9
    ==============  ========  ====  =========  =====  =====
    cells               1.00  2.00       2.00   2.00   2.00
    nodes               1.47  1.48       1.99   1.97   1.98
    boundary nodes      1.01  1.03       1.97   1.96   1.96
    points              1.00  0.99       2.01   2.00   2.00
    ==============  ========  ====  =========  =====  =====

    The centre of a quad is a superconvergent point. Inside the mesh the nodes of linear cells are of second order; the
    boundary nodes, of first order, are fewer by one dimension, which gives 3/2 in the mean square.
    """
    degree, found = DEGREES[cell], errors(cell, measure)
    orders = {name: np.log2(np.array(values[:-1]) / values[1:]) for name, values in found.items()}
    np.testing.assert_allclose(orders["cells"], 2 if cell == "quad" else degree, atol=0.1)
    np.testing.assert_allclose(orders["nodes"], 1.5 if degree == 1 else degree, atol=0.1)
    np.testing.assert_allclose(orders["boundary nodes"], degree, atol=0.1)
    np.testing.assert_allclose(orders["points"], degree, atol=0.1)
