"""Fig. 15 of the paper: how many quadrature points a large shift through a lens needs."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fedic._core import Mesh
from fedic._types import CellName
from fedic.correlation import Correlator
from fedic.experiments.lens import Pair, Scene, textures
from fedic.experiments.lens_errors import measure_pairs, rounding_bound
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.settings import DEFAULT, PAPER, UNFILTERED, Setting
from fedic.quadrature import MeshQuadrature, PixelQuadrature

__all__ = ["run"]

SETTINGS = (PAPER, UNFILTERED, DEFAULT)
RULES = ("diameter", "edges", "rotated")
CELLS: tuple[CellName, ...] = ("quad", "triangle")
RATIOS = (0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0)
QUICK_RATIOS = (0.5, 1.0, 2.0)
SIZE = 20
TEXTURES, QUICK_TEXTURES = 3, 1


def run(request: Request) -> Outcome:
    scene = Scene()
    fine = textures(QUICK_TEXTURES if request.quick else TEXTURES)
    pairs = [pair.rounded() for pair in fine]
    ratios = QUICK_RATIOS if request.quick else RATIOS
    rows: list[Row] = []
    total = len(CELLS) * len(SETTINGS) * (1 + len(RULES) * len(ratios))
    for cell in CELLS:
        mesh = scene.mesh(SIZE, cell)
        bound = rounding_bound(scene, pairs[0], mesh)
        area = float(mesh.areas().sum())
        for setting in SETTINGS:
            for rule, quadrature in _quadratures(scene, pairs[0], mesh, ratios):
                found = measure_pairs(scene, pairs, mesh, setting, quadrature, lens=rule != "pixel")
                rows.append(
                    {
                        "setting": setting.name,
                        "rule": rule,
                        "cell": cell,
                        "points_per_pixel": found.num_points / area,
                    }
                    | found.as_row()
                    | {"bound_px": bound}
                )
                request.progress(len(rows) / total)
    return Outcome("fig15", "t", "x", rows, [], {})


def _quadratures(
    scene: Scene, pair: Pair, mesh: Mesh, ratios: tuple[float, ...]
) -> Iterator[tuple[str, MeshQuadrature | PixelQuadrature]]:
    """Yield the pixel rule, and each rule in the mesh with nearly the wanted numbers of points per pixel."""
    yield "pixel", PixelQuadrature()
    plane, area = scene.in_millimetres(mesh), float(mesh.areas().sum())
    for rule in RULES:
        whole = Correlator(pair.reference, plane, scene.camera, quadrature=MeshQuadrature(rule=rule)).num_points
        for ratio in ratios:
            yield rule, MeshQuadrature(density=ratio * area / whole, rule=rule)
