"""Figures of the convergence experiment."""

import numpy as np
from matplotlib.figure import Figure

from fedic.experiments.convergence_claims import reached
from fedic.experiments.outcome import Row

__all__ = ["basin_figure", "iteration_figure"]

_STARTS = {"zero": "tab:red", "pyramid": "tab:blue", "fft": "tab:green"}
_PANELS = {
    "translation": "largest translation found (px)",
    "rotation": "largest rotation found (degrees)",
    "stretch": "largest stretch found (%)",
}
_MARKERS = ("s", "D", "o", "^", "v", "P", "X")
_LEAST = {"translation": 0.4, "rotation": 0.4, "stretch": 0.8}
_TICKS = {
    "translation": (0.5, 1, 2, 5, 10, 20, 50, 100, 200),
    "rotation": (0.5, 1, 2, 5, 10),
    "stretch": (1, 2, 5, 10, 20),
}


def basin_figure(rows: list[Row]) -> Figure:
    """Draw the largest motion that each start finds.

    Parameters
    ----------
    rows : list of dict
        Rows of all images.

    Returns
    -------
    Figure
        A figure with a row of panels per image.
    """
    images = list(dict.fromkeys(str(row["image"]) for row in rows))
    figure = Figure(figsize=(15.0, 4.1 * len(images)), layout="constrained")
    panels = figure.subplots(len(images), 3, squeeze=False)
    for line, image in zip(panels, images, strict=True):
        most = reached([row for row in rows if row["image"] == image])
        meshes = list(dict.fromkeys((cell, size) for _, _, cell, size in most))
        places = np.arange(len(meshes))
        for axes, (motion, label) in zip(line, _PANELS.items(), strict=True):
            least = _LEAST[motion]
            for offset, (start, colour) in zip((-0.27, 0.0, 0.27), _STARTS.items(), strict=True):
                far = np.array([most[start, motion, cell, size] for cell, size in meshes])
                bars = axes.bar(
                    places + offset, np.maximum(far, least) - least, 0.25, bottom=least, color=colour, label=start
                )
                axes.bar_label(bars, [f"{each:g}" for each in far], fontsize="x-small", padding=1)
            axes.set_xticks(places, labels=[f"{cell}\n{size} px" for cell, size in meshes], fontsize="x-small")
            axes.set(yscale="log", ylabel=label, title=f"{image} image: {motion}")
            axes.set_ylim(least, 3.5 * max(far for (_, kind, _, _), far in most.items() if kind == motion))
            axes.set_yticks(_TICKS[motion], labels=[f"{tick:g}" for tick in _TICKS[motion]])
            axes.grid(visible=True, axis="y", alpha=0.3)
            axes.set_axisbelow(True)
        line[0].legend(fontsize="small", ncols=3, loc="upper left")
    return figure


def iteration_figure(rows: list[Row]) -> Figure:
    """Draw the number of iterations of each set of options from within a pixel.

    Parameters
    ----------
    rows : list of dict
        Rows of all images.

    Returns
    -------
    Figure
        A figure with a panel per image and a line per set of options.
    """
    counted = [row for row in rows if row["study"] == "iterations"]
    images = list(dict.fromkeys(str(row["image"]) for row in counted))
    settings = list(dict.fromkeys(str(row["variant"]) for row in counted))
    meshes = list(dict.fromkeys((str(row["cell"]), int(row["size_px"])) for row in counted))
    figure = Figure(figsize=(4.2 + 4.0 * len(images), 1.4 + 0.3 * len(settings)), layout="constrained")
    panels = figure.subplots(1, len(images), squeeze=False, sharey=True)[0]
    spread = np.linspace(-0.3, 0.3, len(meshes))
    for axes, image in zip(panels, images, strict=True):
        for (cell, size), marker, offset in zip(meshes, _MARKERS, spread, strict=False):
            line = [row for row in counted if (row["image"], row["cell"], row["size_px"]) == (image, cell, size)]
            axes.plot(
                [int(row["iterations"]) for row in line],
                [settings.index(str(row["variant"])) + offset for row in line],
                marker,
                markersize=4.5,
                label=f"{cell}, {size} px",
            )
        axes.set_yticks(range(len(settings)), labels=settings, fontsize="small")
        axes.set_ylim(len(settings) - 0.5, -0.5)
        axes.set_xlim(left=0.0)
        axes.set(xlabel="iterations from a start 1 px away", title=f"{image} image")
        axes.grid(visible=True, axis="x", alpha=0.25)
        for border in range(1, len(settings)):
            axes.axhline(border - 0.5, color="0.9", linewidth=0.6)
    panels[0].legend(fontsize="x-small", loc="lower left", bbox_to_anchor=(0.0, 0.12))
    return figure
