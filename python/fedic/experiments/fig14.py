"""Fig. 14 of the paper: uncertainty and bias over element size under a large shift through a lens."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fedic._internal.types import CellName
from fedic.experiments.lens import SCENE, rounding_floor, textures
from fedic.experiments.lens_errors import measure_pairs, rounding_bound
from fedic.experiments.option_sets import DEFAULT, PAPER, UNFILTERED, OptionSet
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.reference_images import SIZES, window_mesh
from fedic.experiments.style import COLOURS, MARKERS

__all__ = ["run"]

SETTINGS = (PAPER, UNFILTERED, DEFAULT)
CELLS: tuple[CellName, ...] = ("quad", "triangle")
QUICK_SIZES = (10, 20)
SMALLEST_CLAIMED = 10
"""Smallest element size, in pixels, of the claims."""
TEXTURES = 6
LARGEST_BIAS, NEAR_BOUND = 1e-4, 0.1
IGNORED_BIAS = (0.016, 0.020)
"""Expected bias along ``u`` without the lens, in pixels."""


def run(request: Request) -> Outcome:
    """Measure the shift with every element size, cell and setting, with the lens and without.

    Parameters
    ----------
    request : Request
        A quick run has fewer sizes.

    Returns
    -------
    Outcome
        Rows over setting, quadrature, depth, cell and size.
    """
    scene = SCENE
    fine = textures(TEXTURES)
    depths = ((8, [pair.rounded() for pair in fine]), (16, fine[:1]))
    coarse = depths[0][1]
    sizes = QUICK_SIZES if request.quick else SIZES
    total = len(sizes) * len(CELLS) * len(SETTINGS) * len(depths) * 2
    rows: list[Row] = []
    for size in sizes:
        for cell in CELLS:
            mesh = window_mesh(scene.window, size, cell)
            bound = rounding_bound(scene, coarse[0], mesh)
            for setting in SETTINGS:
                for bits, pairs in depths:
                    for kind in ("pixel", "mesh"):
                        rule = setting.quadrature(kind)
                        found = measure_pairs(scene, pairs, mesh, setting, rule, lens=kind == "mesh")
                        rows.append(
                            {
                                "setting": setting.name,
                                "quadrature": kind,
                                "bits": bits,
                                "cell": cell,
                                "size_px": size,
                                **found.as_row(),
                                "bound_px": bound if bits == 8 else np.nan,
                            }
                        )
                        request.report(len(rows) / total)
    floor = float(rounding_floor(scene, coarse[0]).max())
    return Outcome(
        "fig14",
        "A large shift through a lens over element size",
        "A speckled plane seen by the paper's camera (Sect. 5.2: 1388 x 1036 px, 50 mm lens, k1 = -0.0321253) moves "
        f"by (-400, -200) px; {len(fine)} textures, images of 8 bits. Unstructured meshes of 300 x 300 px measure the "
        "motion in millimetres through the calibrated camera (*mesh*) and, the same meshes, in pixels as if there "
        "were no lens (*pixel*). Bias and standard deviation of the error over the nodes are averaged over the "
        "textures; the standard deviation drawn is the root mean square of both components. The bound is that of "
        "Cramér and Rao for rounding noise of 1/sqrt(12) grey levels in each image, from the first 8-bit reference "
        "image without smoothing, root mean square over the nodes and both components. The rounding noise does not "
        f"average out over one mesh: the mean error of one pair is a draw of standard deviation {floor:.1e} px at "
        "best, whatever the method. The first texture in 16 bits shows the error without rounding. *paper*: bicubic "
        "interpolation, finite-difference gradients, diameter rule; *unfiltered*: the default without smoothing; "
        "*default*: the default options of `correlate`.",
        rows,
        [claim for setting in SETTINGS for claim in _claims(setting, rows, floor)],
        {"": _figure(rows, floor)},
    )


def _pick(rows: list[Row], setting: OptionSet, kind: str, bits: int) -> list[Row]:
    """Return the rows of the sizes of the claims."""
    return [
        row
        for row in rows
        if (row["setting"], row["quadrature"], row["bits"]) == (setting.name, kind, bits)
        and int(row["size_px"]) >= SMALLEST_CLAIMED
    ]


def _bias(rows: list[Row]) -> float:
    return max(max(float(row["bias_u_px"]), float(row["bias_v_px"])) for row in rows)


def _claims(setting: OptionSet, rows: list[Row], floor: float) -> list[Claim]:
    lens, fine = _pick(rows, setting, "mesh", 8), _pick(rows, setting, "mesh", 16)
    ratios = np.array([float(row["std_px"]) / float(row["bound_px"]) for row in lens])
    ignored = np.array([float(row["bias_u_px"]) for row in _pick(rows, setting, "pixel", 8)])
    low, high = IGNORED_BIAS
    sizes = f"every size from {SMALLEST_CLAIMED} px"
    return [
        Claim(
            f"{setting.name}, with the lens: mean |bias| at most {LARGEST_BIAS:g} px along u and v, {sizes}",
            f"at most {_bias(lens):.1e} px; {_bias(fine):.1e} px in 16 bits (floor of rounding {floor:.1e} px)",
            _bias(lens) <= LARGEST_BIAS,
        ),
        Claim(
            f"{setting.name}, with the lens: standard deviation within {100 * NEAR_BOUND:.0f} % of the bound of "
            f"rounding, {sizes}",
            f"{ratios.min():.3f} to {ratios.max():.3f} times",
            bool((np.abs(ratios - 1.0) <= NEAR_BOUND).all()),
        ),
        Claim(
            f"{setting.name}, lens ignored: bias along u between {low:g} and {high:g} px, {sizes}",
            f"{ignored.min():.4f} to {ignored.max():.4f} px",
            bool(low <= ignored.min() and ignored.max() <= high),
        ),
    ]


def _figure(rows: list[Row], floor: float) -> Figure:
    figure = Figure(figsize=(13.0, 4.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    coarse = [row for row in rows if row["bits"] == 8]
    for axes, key, label in ((left, "std_px", "standard deviation"), (right, "bias_u_px", "|bias| along u")):
        for (setting, kind), colour in COLOURS.items():
            for cell, marker in MARKERS.items():
                line = [
                    row for row in coarse if (row["setting"], row["quadrature"], row["cell"]) == (setting, kind, cell)
                ]
                lens = "with the lens" if kind == "mesh" else "lens ignored"
                _draw(axes, line, key, f"{setting}, {kind}, {lens}, {cell}", colour, marker, cell)
        axes.set(xlabel="element size (px)", ylabel=f"{label} (px)", yscale="log", title=label)
        axes.grid(visible=True, which="both", alpha=0.25)
    for cell in CELLS:
        bound = [row for row in coarse if (row["setting"], row["quadrature"], row["cell"]) == ("default", "mesh", cell)]
        _draw(left, bound, "bound_px", f"Cramér-Rao bound of rounding, {cell}", "k", "", cell)
        exact = [row for row in rows if (row["setting"], row["quadrature"]) == ("default", "mesh")]
        exact = [row for row in exact if (row["bits"], row["cell"]) == (16, cell)]
        for axes, key in ((left, "std_px"), (right, "bias_u_px")):
            _draw(axes, exact, key, f"default, mesh, with the lens, 16 bits, {cell}", "tab:grey", MARKERS[cell], cell)
    right.axhline(floor, color="k", linestyle=":", label="floor of rounding, one pair")
    handles = dict(zip(*reversed(left.get_legend_handles_labels()), strict=True))
    handles |= dict(zip(*reversed(right.get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), loc="outside right center", fontsize="small", frameon=False)
    return figure


def _draw(axes: Axes, line: list[Row], key: str, label: str, colour: str, marker: str, cell: str) -> None:
    axes.plot(
        [float(row["size_px"]) for row in line],
        [float(row[key]) for row in line],
        marker=marker,
        markersize=4.0,
        color=colour,
        linestyle="-" if cell == "quad" else "--",
        label=label,
    )
