"""Pictures of the star experiment."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fedic.experiments.mei import Measured

__all__ = ["amplitude_figure", "merit_figure", "variant_figure"]

_STYLES = {
    "quad": ("s", "tab:blue"),
    "triangle": ("^", "tab:orange"),
    "quad8": ("D", "tab:green"),
    "quad9": ("o", "tab:red"),
    "triangle6": ("v", "tab:purple"),
}
_GROUPS = ("sizes", "settings", "averages", "nodes", "turned")
_LEVELS = (0.2, 0.25, 0.3, 0.4, 0.6)
_PERIODS = (12.0, 80.0)
_TARGETS = {0.285: "wanted", 0.25: "aim"}
_LEVEL_LABEL_AT = 66.0


def merit_figure(found: list[Measured]) -> Figure:
    """Draw noise over the period resolved, with lines of equal merit.

    Parameters
    ----------
    found : list of Measured
        Measurements; the groups ``sizes`` and ``turned`` are drawn.

    Returns
    -------
    Figure
        A panel per star.
    """
    stars = list(dict.fromkeys(each.star for each in found))
    figure = Figure(figsize=(6.2 * len(stars), 5.4), layout="constrained")
    panels = figure.subplots(1, len(stars), squeeze=False, sharey=True)[0]
    for axes, star in zip(panels, stars, strict=True):
        _draw_levels(axes)
        for cell, (marker, colour) in _STYLES.items():
            line = [each for each in found if (each.star, each.group, each.cell) == (star, "sizes", cell)]
            axes.plot(
                [each.merit.period for each in line],
                [each.merit.noise for each in line],
                marker=marker,
                markersize=5,
                color=colour,
                label=_sizes_label(cell, [each.size for each in line]),
            )
            for each in line:
                axes.plot(
                    [each.merit.period, each.merit.kept_period], [each.merit.noise] * 2, color=colour, linewidth=0.8
                )
            for each in found:
                if (each.star, each.group, each.cell) == (star, "turned", cell):
                    axes.plot(
                        each.merit.period, each.merit.noise, marker=marker, markersize=9, color=colour, fillstyle="none"
                    )
        axes.plot([], [], "o", color="grey", markersize=9, fillstyle="none", label="turned by 45°")
        axes.set(
            xscale="log",
            yscale="log",
            xlim=_PERIODS,
            ylim=(0.004, 0.03),
            xlabel="shortest period resolved (px)",
            title=f"{star} star",
        )
        axes.set_xticks([15, 20, 30, 40, 60], labels=["15", "20", "30", "40", "60"])
        axes.set_xticks([], minor=True)
        ticks = [0.005, 0.007, 0.01, 0.015, 0.02]
        axes.set_yticks(ticks, labels=[f"{tick:g}" for tick in ticks])
        axes.set_yticks([], minor=True)
    panels[0].set_ylabel("noise of the field (px)")
    panels[0].legend(fontsize="small", loc="lower left", title="plain setting")
    return figure


def _sizes_label(cell: str, sizes: list[int]) -> str:
    return f"{cell}, {sizes[0]} px" if len(sizes) == 1 else f"{cell}, {sizes[0]} to {sizes[-1]} px"


def _draw_levels(axes: Axes) -> None:
    periods = np.array(_PERIODS)
    for level in _LEVELS:
        axes.plot(periods, level / periods, color="0.8", linewidth=0.8, zorder=0)
        at = min(_LEVEL_LABEL_AT, level / 0.0046)
        axes.text(
            at,
            level / at,
            f"MEI {level:g}",
            color="0.5",
            fontsize="x-small",
            rotation=-45,
            ha="center",
            va="center",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5},
            zorder=0,
        )


def amplitude_figure(found: list[Measured]) -> Figure:
    """Draw the amplitude over the period for the best size of each cell, straight and turned.

    Parameters
    ----------
    found : list of Measured
        Measurements; the groups ``sizes`` and ``turned`` are drawn.

    Returns
    -------
    Figure
        A row of panels per star.
    """
    stars = list(dict.fromkeys(each.star for each in found))
    turned = {(each.cell, each.size) for each in found if each.group == "turned"}
    figure = Figure(figsize=(15.0, 4.1 * len(stars)), layout="constrained")
    panels = figure.subplots(len(stars), 3, squeeze=False, sharex=True, sharey=True)
    for row, star in zip(panels, stars, strict=True):
        straight = [each for each in found if (each.star, each.group) == (star, "sizes")]
        for axes, candidates, title in (
            (row[0], straight, "best size of each cell"),
            (row[1], [each for each in straight if (each.cell, each.size) in turned], "the sizes turned at right"),
            (row[2], [each for each in found if (each.star, each.group) == (star, "turned")], "turned by 45°"),
        ):
            axes.axhline(1.0, color="0.7", linewidth=0.8)
            axes.axhline(0.9, color="0.4", linewidth=0.8, linestyle="--")
            for cell, (_, colour) in _STYLES.items():
                best = min(
                    (each for each in candidates if each.cell == cell),
                    key=lambda each: each.merit.kept_mei,
                    default=None,
                )
                if best is not None:
                    axes.plot(
                        best.merit.periods,
                        best.merit.amplitudes,
                        color=colour,
                        linewidth=1.2,
                        label=f"{cell}, {best.size} px: MEI {best.merit.mei:.3f}",
                    )
            axes.set(xlim=(12.0, 140.0), ylim=(-0.1, 2.1), title=f"{star} star: {title}")
            axes.legend(fontsize="small", loc="upper right")
            axes.grid(visible=True, alpha=0.25)
        row[0].set_ylabel("measured / true amplitude")
    for axes in panels[-1]:
        axes.set_xlabel("period of the wave (px)")
    return figure


def variant_figure(found: list[Measured]) -> Figure:
    """Draw the merit of every way of measuring.

    Parameters
    ----------
    found : list of Measured
        All of one star.

    Returns
    -------
    Figure
        Ways downwards, MEI to the right.
    """
    tried = {(each.cell, each.size) for each in found if each.group == "settings"}
    shown = [
        each
        for each in found
        if each.group in ("settings", "averages", "nodes")
        or (each.group in ("sizes", "turned") and (each.cell, each.size) in tried)
    ]
    shown.sort(key=lambda each: _GROUPS.index(each.group))
    ways = list(dict.fromkeys(each.variant for each in shown))
    figure = Figure(figsize=(8.5, 1.6 + 0.27 * len(ways)), layout="constrained")
    axes = figure.add_subplot()
    for limit, name in _TARGETS.items():
        axes.axvline(limit, color="0.6", linewidth=0.8, linestyle="--")
        axes.text(limit, -0.9, f"{name}\n{limit:g}", fontsize="x-small", color="0.4", ha="center", va="bottom")
    labelled = set()
    for each in shown:
        reconstructed = each.variant.startswith("8 px")
        marker, colour = ("P", "black") if reconstructed else _STYLES[each.cell]
        name = "reconstructed" if reconstructed else f"{each.cell}, {each.size} px"
        row = ways.index(each.variant)
        axes.plot(each.merit.mei, row, marker, color=colour, markersize=6, label=None if name in labelled else name)
        labelled.add(name)
        if math.isfinite(each.merit.kept_mei) and each.merit.kept_mei > 1.01 * each.merit.mei:
            axes.plot([each.merit.mei, each.merit.kept_mei], [row, row], color=colour, linewidth=0.8, zorder=0)
            axes.plot(each.merit.kept_mei, row, marker, color=colour, markersize=6, fillstyle="none")
    axes.plot(
        [], [], "o", color="grey", fillstyle="none", label="by the period from which on\nthe amplitude stays above 0.9"
    )
    axes.set_yticks(range(len(ways)), labels=ways, fontsize="small")
    axes.set_ylim(len(ways) - 0.4, -0.6)
    axes.set_xlabel(f"MEI (px²), {found[0].star} star")
    axes.grid(visible=True, axis="y", alpha=0.25)
    axes.legend(fontsize="small", loc="center right")
    return figure
