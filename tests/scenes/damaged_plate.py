"""A speckled plate before and after a deformation with damage of known extent, in pixels."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import fedic

Grey = NDArray[np.uint8]
Floats = NDArray[np.float64]

SIDE = 320
NOISE = 2.0
LINE = 159.5
"""Row of the crack in the reference image."""
OPENING = 6.0
_STRETCH, _SHIFT = np.array([0.997, 1.008]), np.array([1.3, -0.7])
_CENTRE = 0.5 * (SIDE - 1)
CHIPS = ((110.0, 120.0, 17.0), (215.0, 205.0, 14.0), (130.0, 230.0, 9.0))
"""Centres and radii of the chips in the reference image."""


@dataclass(frozen=True)
class Damaged:
    """Both images, the displacement of material points, and which of them the deformed image does not show."""

    reference: Grey
    deformed: Grey
    displacement: Callable[[Floats], Floats]
    hidden: Callable[[Floats], NDArray[np.bool_]]


def displacement(points: Floats) -> Floats:
    """Return the displacement without a crack."""
    found: Floats = (points - _CENTRE) * (_STRETCH - 1.0) + _SHIFT
    return found


def _grid() -> Floats:
    v, u = np.mgrid[:SIDE, :SIDE].astype(float)
    return np.stack([u, v], axis=-1).reshape(-1, 2)


def _exposed(light: Floats, seed: int) -> Grey:
    noisy = light + np.random.default_rng(seed).normal(0.0, NOISE, light.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8).reshape(SIDE, SIDE)


def damaged(kind: str, seed: int = 0) -> Damaged:
    """Render a pair: ``"clean"``, ``"chips"``, ``"crack"`` or ``"shadow"``."""
    texture, grid = fedic.synthetic.Speckle(5.0, seed=seed + 3), _grid()
    grey = lambda points: 30.0 + 170.0 * texture.values(np.ascontiguousarray(points))  # noqa: E731
    reference = _exposed(grey(grid), 10 * seed + 1)

    def back(points: Floats) -> Floats:
        found: Floats = (points - _SHIFT - _CENTRE) / _STRETCH + _CENTRE
        return found

    def moved(points: Floats) -> Floats:
        return displacement(points)

    def hidden(points: Floats) -> NDArray[np.bool_]:
        return np.zeros(len(points), dtype=bool)

    material = back(grid)
    light = grey(material)
    if kind == "chips":

        def hidden(points: Floats) -> NDArray[np.bool_]:
            inside = [np.hypot(points[:, 0] - u, points[:, 1] - v) < radius for u, v, radius in CHIPS]
            return np.any(inside, axis=0)

        light[hidden(material)] = 215.0
    elif kind == "crack":
        half = 0.5 * OPENING
        crack = LINE + displacement(np.array([[_CENTRE, LINE]]))[0, 1]
        above, below = grid[:, 1] < crack - half, grid[:, 1] > crack + half
        light = np.full(len(grid), 8.0)
        for part, sign in ((above, 1.0), (below, -1.0)):
            light[part] = grey(back(grid[part] + [0.0, sign * half]))

        def moved(points: Floats) -> Floats:
            jump = np.column_stack([np.zeros(len(points)), half * np.sign(points[:, 1] - LINE)])
            return displacement(points) + jump

        def hidden(points: Floats) -> NDArray[np.bool_]:
            return np.abs(points[:, 1] - LINE) < 1.0

    elif kind == "shadow":
        across = (grid[:, 0] - 150.0) * np.cos(0.5) + (grid[:, 1] - 160.0) * np.sin(0.5)
        light *= 1.0 - 0.3 / (1.0 + np.exp(-across / 20.0))
    return Damaged(reference, _exposed(light, 10 * seed + 2), moved, hidden)


def hidden_shares(mesh: fedic.Mesh, scene: Damaged) -> Floats:
    """Return the hidden share of each cell of a mesh of pixels."""
    grid = _grid()
    cells = np.arange(mesh.num_cells, dtype=float)
    shares = []
    nodes = [each for block in mesh.cells.values() for each in block]
    hidden = scene.hidden(grid).reshape(SIDE, SIDE)
    for cell in cells.astype(int):
        corners = mesh.points[nodes[cell][: 3 if len(nodes[cell]) in (3, 6) else 4], :2]
        low, high = np.floor(corners.min(axis=0)).astype(int), np.ceil(corners.max(axis=0)).astype(int)
        v, u = np.mgrid[low[1] : high[1] + 1, low[0] : high[0] + 1]
        edges = np.roll(corners, -1, axis=0) - corners
        inside = np.ones(u.shape, dtype=bool)
        for (x, y), (along, down) in zip(corners, edges, strict=True):
            inside &= along * (v - y) - down * (u - x) >= 0
        shares.append(hidden[v[inside], u[inside]].mean() if inside.any() else 0.0)
    return np.array(shares)


def good_nodes(mesh: fedic.Mesh, shares: Floats) -> NDArray[np.bool_]:
    """Return the nodes of cells without any hidden point."""
    good = np.ones(mesh.num_nodes, dtype=bool)
    nodes = [each for block in mesh.cells.values() for each in block]
    for cell in np.flatnonzero(shares > 0.0):
        good[nodes[cell]] = False
    return good
