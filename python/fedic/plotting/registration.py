"""Mesh, edges and points of a registration drawn over the image."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.plotting.colour_maps import DISTANCE
from fedic.plotting.fields import plot_mesh

__all__ = ["draw_registration"]

_LARGEST_PERCENTILE = 98.0


def draw_registration(
    mesh: Mesh,
    camera: Camera,
    image: Image,
    *,
    edges: tuple[Floats, Floats, NDArray[np.bool_]] | None,
    points: tuple[Floats, Floats],
    lines: Sequence[str],
) -> Figure:
    """Draw the mesh over the image, the edges found coloured by distance, and the point pairs.

    Parameters
    ----------
    mesh, camera, image
        See `fedic.plotting.plot_mesh`.
    edges : (ndarray (n, 2), ndarray (n,), ndarray of bool (n,)), optional
        Edge points in the image, their distances from the features and whether they were used.
    points : (ndarray (m, 2), ndarray (m, 2))
        Image points of the point pairs and their residuals, measured minus projected.
    lines : sequence of str
        Lines of the title.

    Returns
    -------
    Figure
        The figure; `fedic.plotting.save_figure` writes it.
    """
    figure = plot_mesh(mesh, camera, image)
    axes = figure.axes[0]
    for collection in axes.collections:
        collection.set(alpha=0.5)
    if edges is not None:
        _draw_edges(figure, axes, *edges)
    pixels, residuals = points
    if len(pixels):
        axes.plot(*pixels.T, "+", color="cyan", label="points, measured")
        axes.plot(*(pixels - residuals).T, ".", color="lime", markersize=3, label="projected")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper right", fontsize="small")
    axes.set_title("\n".join(lines), fontsize="small")
    return figure


def _draw_edges(figure: Figure, axes: Axes, pixels: Floats, distances: Floats, used: NDArray[np.bool_]) -> None:
    limit = max(float(np.percentile(np.abs(distances[used]), _LARGEST_PERCENTILE)), 1e-3)
    drawn = axes.scatter(
        pixels[used, 0],
        pixels[used, 1],
        s=14,
        c=distances[used],
        cmap=DISTANCE,
        vmin=-limit,
        vmax=limit,
        edgecolors="black",
        linewidths=0.3,
        zorder=3,
    )
    figure.colorbar(drawn, ax=axes, label="edge from the mesh, positive outwards (px)", extend="both", shrink=0.8)
    left_out = ~used & np.isfinite(pixels).all(axis=1)
    if left_out.any():
        u, v = pixels[left_out].T
        axes.scatter(u, v, marker="x", c="red", s=14, linewidths=0.8, zorder=3, label="left out")
