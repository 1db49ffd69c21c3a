"""The picture of a registration: the mesh over the image, with the edges and points it was placed by."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from fedic.plotting.fields import plot_mesh

if TYPE_CHECKING:
    from fedic.registration._result import Registration

__all__ = ["draw_registration"]

_FARTHEST_PERCENT = 98.0


def draw_registration(registration: "Registration") -> Figure:
    """Draw the mesh over the image, the edges found coloured by distance, and the point pairs.

    Parameters
    ----------
    registration : Registration
        What to draw.

    Returns
    -------
    Figure
        Save it with `fedic.plotting.fields.save_figure`.
    """
    figure = plot_mesh(registration.mesh, registration.camera, registration.image)
    axes = figure.axes[0]
    for collection in axes.collections:
        collection.set(alpha=0.5)
    features = list(registration.features.values())
    if features:
        pixels = np.concatenate([each.pixels for each in features])
        distances = np.concatenate([each.distances for each in features])
        used = np.concatenate([each.used for each in features])
        reach = max(float(np.percentile(np.abs(distances[used]), _FARTHEST_PERCENT)), 1e-3)
        drawn = axes.scatter(
            pixels[used, 0],
            pixels[used, 1],
            s=14,
            c=distances[used],
            cmap="coolwarm",
            vmin=-reach,
            vmax=reach,
            edgecolors="black",
            linewidths=0.3,
            zorder=3,
        )
        figure.colorbar(drawn, ax=axes, label="edge from the mesh, positive outwards (px)", extend="both", shrink=0.8)
        left_out = ~used & np.isfinite(pixels).all(axis=1)
        if left_out.any():
            u, v = pixels[left_out].T
            axes.scatter(u, v, marker="x", c="red", s=14, linewidths=0.8, zorder=3, label="left out")
    if len(registration.pixels):
        axes.plot(*registration.pixels.T, "+", color="cyan", label="points, seen")
        axes.plot(*(registration.pixels - registration.residuals).T, ".", color="lime", markersize=3, label="projected")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper right", fontsize="small")
    lines = [
        f"{each.name}: {each.median:.2f} px median, {each.used.sum()} of {len(each.used)} pieces" for each in features
    ]
    if len(registration.residuals):
        rms = float(np.sqrt((registration.residuals**2).sum(axis=1).mean()))
        lines.append(f"{len(registration.residuals)} points: {rms:.3f} px rms")
    axes.set_title("\n".join(lines), fontsize="small")
    return figure
