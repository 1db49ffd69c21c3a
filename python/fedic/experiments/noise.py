"""Measured and predicted uncertainty over noise, element size and cell type, by Monte Carlo."""

from itertools import product

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fedic._core import ImageFrame, Mesh, rectangle_mesh
from fedic._internal.types import CellName, Floats
from fedic.correlation import Correlator
from fedic.demo.scene import LEVELS, SPECKLE
from fedic.experiments.option_sets import DEFAULT, LEGEND, UNFILTERED, OptionSet
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.sweep import draw_displacements, noise_bound, rms
from fedic.plotting import draw_nodal_field
from fedic.synthetic import Speckle, add_noise, render

__all__ = ["run"]

SHAPE = (220, 260)
BOUNDS = (30.3, 30.7, 230.7, 190.3)
MOTION = (0.4, -0.3)
CELLS: tuple[CellName, ...] = ("quad", "triangle", "quad8", "quad9", "triangle6")
SETTINGS = (UNFILTERED, DEFAULT)
NOISES, SIZES = (0.5, 1.0, 2.0, 4.0, 8.0), (8.0, 12.0, 20.0, 30.0)
NOISE, SIZE = 2.0, 20.0
"""Values for the cases in which other quantities vary."""
MODERATE = 4.0
"""Largest noise of the claims, in grey levels: about 15 % of the gradient per pixel."""
DRAWS, DRAWS_OF_THE_MAP = 60, 2000
QUICK_NOISES, QUICK_SIZES, QUICK_DRAWS, QUICK_DRAWS_OF_THE_MAP = (2.0,), (20.0,), 10, 200


def run(request: Request) -> Outcome:
    """Measure many pairs of noisy images of a known motion, and compare the scatter with the prediction.

    Parameters
    ----------
    request : Request
        Quick or not.

    Returns
    -------
    Outcome
        Rows over setting, cell, element size and noise.
    """
    texture = Speckle(SPECKLE, seed=1)
    reference, deformed = (
        render(texture, ImageFrame(), SHAPE, displacement=motion, levels=LEVELS, bits=16).astype(np.float32) / 257.0
        for motion in (None, MOTION)
    )
    noises, sizes = (QUICK_NOISES, QUICK_SIZES) if request.quick else (NOISES, SIZES)
    draws, map_draws = (QUICK_DRAWS, QUICK_DRAWS_OF_THE_MAP) if request.quick else (DRAWS, DRAWS_OF_THE_MAP)
    cases: list[tuple[CellName, float, float, int]] = [("quad", SIZE, NOISE, map_draws)]
    cases += [(cell, SIZE, NOISE, draws) for cell in CELLS[1:]]
    cases += [(CELLS[0], SIZE, noise, draws) for noise in noises if noise != NOISE]
    cases += [(cell, size, NOISE, draws) for size, cell in product(sizes, CELLS[:2]) if size != SIZE]
    rows: list[Row] = []
    maps: dict[str, tuple[Mesh, Floats, Floats]] = {}
    for setting, (cell, size, noise, count) in product(SETTINGS, cases):
        mesh = rectangle_mesh(BOUNDS, size=size, cell=cell)
        errors = _errors(reference, deformed, mesh, setting, noise, count)
        predicted = _predicted(reference, mesh, setting, noise)
        if count == map_draws:
            maps[setting.name] = (mesh, errors, predicted)
        rows.append(_row(reference, mesh, setting, cell, size, noise, errors, predicted))
        request.report(len(rows) / (len(SETTINGS) * len(cases)))
    return Outcome(
        "noise",
        "Measured and predicted uncertainty",
        "A synthetic speckle moved by (0.4, -0.3) px; Gaussian noise is added to both images, and the displacement "
        f"measured: {map_draws} draws for quads of {SIZE:g} px at {NOISE:g} grey levels, {draws} for each other case. "
        "*predicted* is `Correlator.standard_deviations` of the image without noise, *as a user would*, of one noisy "
        "reference image; *bound* is the Cramér-Rao bound, the prediction without smoothing: root mean squares "
        "over the nodes. A smoothing also reads pixels beyond the edge of the mesh, which the bound does not count: "
        f"the scatter may then lie below it. {LEGEND}",
        rows,
        _claims(rows),
        {"": _figure(rows), "map": _map_figure(*maps[DEFAULT.name])},
    )


def _errors(
    reference: NDArray[np.float32],
    deformed: NDArray[np.float32],
    mesh: Mesh,
    setting: OptionSet,
    noise: float,
    draws: int,
) -> Floats:
    found = draw_displacements(reference, deformed, mesh, setting, setting.mesh, noise, draws, start=MOTION)
    return np.asarray(found - MOTION)


def _predicted(reference: NDArray[np.float32], mesh: Mesh, setting: OptionSet, noise: float) -> Floats:
    correlator = Correlator(reference, mesh, quadrature=setting.mesh, **setting.options)
    return correlator.standard_deviations(noise)


def _row(
    reference: NDArray[np.float32],
    mesh: Mesh,
    setting: OptionSet,
    cell: CellName,
    size: float,
    noise: float,
    errors: Floats,
    predicted: Floats,
) -> Row:
    measured = errors.std(axis=0, ddof=1)
    noisy = add_noise(reference, noise=noise, seed=0)
    means = errors.mean(axis=1)
    uncertainty = means.std(axis=0, ddof=1) / np.sqrt(len(means))
    mean_u, mean_v = (float(mean) for mean in means.mean(axis=0))
    return {
        "setting": setting.name,
        "cell": cell,
        "size_px": size,
        "noise": noise,
        "draws": len(errors),
        "measured_px": rms(measured),
        "predicted_px": rms(predicted),
        "as_a_user_px": rms(_predicted(noisy, mesh, setting, noise)),
        "bound_px": noise_bound(reference, mesh, noise),
        "measured_over_predicted": rms(measured / predicted),
        "mean_error_u_px": mean_u,
        "mean_error_v_px": mean_v,
        "mean_error_uncertainty_px": float(uncertainty.max()),
        "mean_error_in_uncertainties": float(np.abs(means.mean(axis=0) / uncertainty).max()),
    }


def _claims(rows: list[Row]) -> list[Claim]:
    claims = []
    for setting in SETTINGS:
        mine = [row for row in rows if row["setting"] == setting.name]
        longest = mine[0]
        ratio = longest["measured_over_predicted"]
        off = longest["mean_error_in_uncertainties"]
        claims += [
            Claim(
                f"{setting.name}: over {longest['draws']} draws the map of the standard deviation equals the predicted "
                "one within 5 % over the nodes",
                f"measured / predicted {ratio:.3f} (quads of {SIZE:g} px, noise {NOISE:g})",
                abs(ratio - 1.0) <= 0.05,
            ),
            Claim(
                f"{setting.name}: over {longest['draws']} draws the mean error is zero within 2.5 times its own "
                "uncertainty",
                f"({longest['mean_error_u_px']:.1e}, {longest['mean_error_v_px']:.1e}) px, "
                f"uncertainty {longest['mean_error_uncertainty_px']:.1e} px: {off:.1f} times",
                off <= 2.5,
            ),
        ]
        cells = {
            row["cell"]: row["measured_over_predicted"]
            for row in mine
            if row["noise"] == NOISE and row["size_px"] == SIZE
        }
        claims.append(
            Claim(
                f"{setting.name}: measured / predicted within 10 % for every kind of cell",
                ", ".join(f"{cell} {value:.2f}" for cell, value in cells.items()),
                max(abs(value - 1.0) for value in cells.values()) <= 0.10,
            )
        )
        over = {(row["noise"], row["cell"], row["size_px"]): row["measured_px"] / row["bound_px"] for row in mine}
        moderate = [ratio for (noise, _, _), ratio in over.items() if noise <= MODERATE]
        strong = [f", {ratio:.2f} times at {noise:g}" for (noise, _, _), ratio in over.items() if noise > MODERATE]
        claims.append(
            Claim(
                f"{setting.name}: noise within 5 % of the Cramér-Rao bound for every cell and size, up to {MODERATE:g} "
                "grey levels",
                f"{min(moderate):.2f} to {max(moderate):.2f} times the bound{''.join(strong)}",
                max(moderate) <= 1.05,
            )
        )
    return claims


def _figure(rows: list[Row]) -> Figure:
    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    over_noise, over_size = figure.subplots(1, 2)
    for setting, colour in ((UNFILTERED, "tab:blue"), (DEFAULT, "tab:green")):
        mine = [row for row in rows if row["setting"] == setting.name]
        noises = sorted((r for r in mine if r["cell"] == "quad" and r["size_px"] == SIZE), key=lambda r: r["noise"])
        sizes = sorted((r for r in mine if r["cell"] == "quad" and r["noise"] == NOISE), key=lambda r: r["size_px"])
        for axes, line, key in ((over_noise, noises, "noise"), (over_size, sizes, "size_px")):
            x = [row[key] for row in line]
            axes.plot(x, [r["measured_px"] for r in line], "s", color=colour, label=f"{setting.name}: measured")
            axes.plot(x, [r["predicted_px"] for r in line], "-", color=colour, label=f"{setting.name}: predicted")
            label = "Cramér-Rao bound" if setting is DEFAULT else None
            axes.plot(x, [r["bound_px"] for r in line], ":", color="black", label=label)
    over_noise.set(xlabel="noise (grey levels)", title=f"quads of {SIZE:g} px")
    over_size.set(xlabel="element size (px)", title=f"quads, noise of {NOISE:g} grey levels")
    for axes, key in ((over_noise, "noise"), (over_size, "size_px")):
        axes.set(xscale="log", yscale="log", ylabel="standard deviation at the nodes (px)")
        values = sorted({row[key] for row in rows})
        axes.set_xticks(values, [f"{value:g}" for value in values])
        axes.set_xticks([], minor=True)
        axes.grid(visible=True, which="both", alpha=0.25)
    over_noise.legend(fontsize="small")
    return figure


def _map_figure(mesh: Mesh, errors: Floats, predicted: Floats) -> Figure:
    figure = Figure(figsize=(13.0, 3.9), layout="compressed")
    left, middle, right = figure.subplots(1, 3)
    measured = errors.std(axis=0, ddof=1)
    limits = (0.0, float(max(measured[:, 0].max(), predicted[:, 0].max())))
    for axes, values, title in ((left, measured, "measured"), (middle, predicted, "predicted")):
        colours = draw_nodal_field(axes, mesh, mesh.points, values[:, 0], limits=limits)
        axes.set(title=f"{title} standard deviation of u (px)", xlabel="u (px)", ylabel="v (px)", aspect="equal")
        axes.invert_yaxis()
    figure.colorbar(colours, ax=(left, middle), shrink=0.8)
    scores = (errors / predicted).ravel()
    bins = np.linspace(-4.0, 4.0, 81)
    right.hist(scores, bins=bins, density=True, color="tab:green", alpha=0.6, label="error / predicted deviation")
    right.plot(bins, np.exp(-0.5 * bins**2) / np.sqrt(2.0 * np.pi), color="black", label="normal law")
    right.set(xlabel="error / predicted standard deviation", ylabel="density")
    right.legend(fontsize="small", loc="lower center")
    return figure
