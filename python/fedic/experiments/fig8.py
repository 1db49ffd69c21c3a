"""Fig. 8 of the paper: error and noise over the number of quadrature points."""

from itertools import product
from typing import Literal

import numpy as np
from matplotlib.figure import Figure

from fedic._internal.types import CellName, Floats
from fedic.experiments.option_sets import DEFAULT, LEGEND, PAPER, UNFILTERED, OptionSet
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.reference_images import ReferenceImage, reference_images, window_mesh
from fedic.experiments.style import MARKERS
from fedic.experiments.sweep import draw_displacements, measure_shifts, noise_bound, rms
from fedic.quadrature import MeshQuadrature, PixelQuadrature, Quadrature

__all__ = ["run"]

SIZE = 20
SHIFTS = ((0.3, 0.0), (0.4, 0.0), (0.5, 0.0))
SETTINGS = (PAPER, UNFILTERED, DEFAULT)
RULES: tuple[Literal["edges", "rotated", "diameter"], ...] = ("edges", "rotated", "diameter")
CELLS: tuple[CellName, ...] = ("quad", "triangle")
QUICK_CELLS: tuple[CellName, ...] = ("quad",)
DENSITIES, QUICK_DENSITIES = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0), (0.5, 1.0, 2.0)
NOISE = 2.0
"""Standard deviation of the noise of each image, in grey levels."""
DRAWS, QUICK_DRAWS = 30, 10

_COLOURS = {"edges": "tab:blue", "rotated": "tab:green", "diameter": "tab:orange", "pixel": "tab:red"}


def run(request: Request) -> Outcome:
    """Measure error and noise over the density of each rule.

    Parameters
    ----------
    request : Request
        Its image, if given, is measured in addition to the synthetic one. A quick run has quads only.

    Returns
    -------
    Outcome
        Rows over image, setting, cell, rule and density.
    """
    images = reference_images(request)
    rows: list[Row] = []
    for index, subject in enumerate(images):
        rows += _measure(subject, request.part(index, len(images)))
    names = [subject.name for subject in images]
    return Outcome(
        "fig8",
        "How many quadrature points are enough",
        f"Unstructured meshes of {SIZE} px. Error: the translations of Fig. 7, without noise. Noise: standard "
        f"deviation, over {QUICK_DRAWS if request.quick else DRAWS} draws of {NOISE:g} grey levels added to both "
        "images, the second moved by 0.4 px, root mean square over the nodes, divided by the Cramér-Rao bound: the "
        f"prediction `standard_deviations({NOISE:g})` without smoothing from the image without that noise. {LEGEND}",
        rows,
        [claim for name in names for claim in _claims(name, rows)],
        {name if len(names) > 1 else "": _figure(name, rows) for name in names},
    )


def _measure(subject: ReferenceImage, request: Request) -> list[Row]:
    reference = subject.reference
    deformed = [subject.shifted(shift) for shift in SHIFTS]
    densities = QUICK_DENSITIES if request.quick else DENSITIES
    rules: list[tuple[str, float, Quadrature]] = [("pixel", 1.0, PixelQuadrature())]
    rules += [(rule, d, MeshQuadrature(density=d, rule=rule)) for rule, d in product(RULES, densities)]
    area = float(np.prod(np.subtract(subject.window[2:], subject.window[:2])))
    rows: list[Row] = []
    cells = QUICK_CELLS if request.quick else CELLS
    total = len(cells) * len(SETTINGS) * len(rules)
    for cell, setting in product(cells, SETTINGS):
        mesh = window_mesh(subject.window, SIZE, cell)
        bound = noise_bound(reference, mesh, NOISE)
        for rule, density, quadrature in rules:
            found = measure_shifts(reference, deformed, SHIFTS, mesh, setting, quadrature)
            draws = draw_displacements(
                reference,
                deformed[1],
                mesh,
                setting,
                quadrature,
                NOISE,
                QUICK_DRAWS if request.quick else DRAWS,
                start=SHIFTS[1],
            )
            noise = rms(draws.std(axis=0, ddof=1))
            place = {"image": subject.name, "setting": setting.name, "cell": cell, "rule": rule, "density": density}
            figures = {"points_per_pixel": found.num_points / area, "noise_over_bound": noise / bound}
            rows.append(place | figures | found.as_row())
            request.report(len(rows) / total)
    return rows


def _claims(image: str, rows: list[Row]) -> list[Claim]:
    def ratio(setting: OptionSet, cell: str, rule: str, density: float) -> float:
        wanted = (image, setting.name, cell, rule, density)
        for row in rows:
            if tuple(row[key] for key in ("image", "setting", "cell", "rule", "density")) == wanted:
                return float(row["noise_over_bound"])
        raise KeyError(wanted)

    cells = _cells(rows)
    claims = []
    for rule in ("edges", "rotated"):
        one = np.array([ratio(UNFILTERED, cell, rule, 1.0) for cell in cells])
        half = np.array([ratio(UNFILTERED, cell, rule, 0.5) for cell in cells]) / one
        twice = np.array([ratio(UNFILTERED, cell, rule, 2.0) for cell in cells]) / one
        head = f"{image} image, unfiltered, {rule}"
        claims += [
            Claim(
                f"{head}: noise at density 1 within 3 % of the Cramér-Rao bound",
                _listed(cells, one),
                bool(np.abs(one - 1.0).max() <= 0.03),
            ),
            Claim(
                f"{head}: at half the points at least 4 % more noise", _listed(cells, half), bool(half.min() >= 1.04)
            ),
            Claim(
                f"{head}: at twice the points less than 2 % gained",
                _listed(cells, twice),
                bool(twice.min() >= 0.98),
            ),
        ]
    default = np.array([ratio(DEFAULT, cell, "rotated", 1.0) for cell in cells])
    half = np.array([ratio(DEFAULT, cell, "rotated", 0.5) for cell in cells]) / default
    claims.append(
        Claim(
            f"{image} image, default: the smoothing makes half the points cost less than 4 % of noise",
            f"{_listed(cells, half)}; at density 1 {_listed(cells, default)} of the bound",
            bool(half.max() < 1.04),
        )
    )
    return claims


def _cells(rows: list[Row]) -> list[str]:
    return list(dict.fromkeys(str(row["cell"]) for row in rows))


def _listed(cells: list[str], ratios: Floats) -> str:
    return ", ".join(f"{cell} {ratio:.3f}" for cell, ratio in zip(cells, ratios, strict=True))


def _figure(image: str, rows: list[Row]) -> Figure:
    figure = Figure(figsize=(13.0, 3.6 * len(SETTINGS)), layout="constrained")
    panels = figure.subplots(len(SETTINGS), 3, sharex=True, squeeze=False)
    columns = (
        ("std_px", "standard deviation (px)", "log"),
        ("bias_px", "|bias| (px)", "log"),
        ("noise_over_bound", "noise / Cramér-Rao bound", "linear"),
    )
    for axes_row, setting in zip(panels, SETTINGS, strict=True):
        for axes, (key, label, scale) in zip(axes_row, columns, strict=True):
            for cell, rule in product(_cells(rows), ("edges", "rotated", "diameter", "pixel")):
                line = [
                    r
                    for r in rows
                    if (r["image"], r["setting"], r["cell"], r["rule"]) == (image, setting.name, cell, rule)
                ]
                axes.plot(
                    [100.0 * row["points_per_pixel"] for row in line],
                    [row[key] for row in line],
                    marker=MARKERS[cell],
                    color=_COLOURS[rule],
                    linestyle="-" if cell == "quad" else "--",
                    label=f"{rule}, {cell}",
                )
            axes.set(xscale="log", yscale=scale, ylabel=label, title=f"{image} image, {setting.name}")
            if key == "noise_over_bound":
                axes.set_ylim(0.95, 1.6)
                axes.axhline(1.0, color="grey", linewidth=0.8)
            axes.axvline(100.0, color="grey", linewidth=0.8)
            axes.grid(visible=True, which="both", alpha=0.25)
    for axes in panels[-1]:
        axes.set_xlabel("points per pixel (%)")
    panels[0][2].legend(fontsize="x-small", ncols=2)
    return figure
