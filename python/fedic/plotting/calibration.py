"""Residual vectors of a calibration and its coverage of the image."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.plotting.colour_maps import COUNT

__all__ = ["draw_residuals"]

_INCHES = 8.0
_CELLS = 16
_ARROW = 0.02
"""Length of the arrow of a root mean square residual, in widths of the image."""


def draw_residuals(
    pixels: Floats,
    residuals: Floats,
    used: NDArray[np.bool_],
    *,
    image_size: tuple[int, int],
    principal_point: tuple[float, float],
    rms: float,
    title: str,
) -> Figure:
    """Draw residual vectors, enlarged, over the number of points in each part of the image.

    Parameters
    ----------
    pixels, residuals : ndarray, shape (n, 2)
        Positions of the points and their residuals, in pixels.
    used : ndarray of bool, shape (n,)
        False for points left out of the fit, which are drawn in red.
    image_size : (int, int)
        Width and height in pixels.
    principal_point : (float, float)
        Principal point in pixels.
    rms : float
        Residual whose arrow has a fixed length, in pixels.
    title : str
        First part of the title.

    Returns
    -------
    Figure
        The figure; `fedic.plotting.save_figure` writes it.
    """
    width, height = image_size
    figure = Figure(figsize=(_INCHES + 1.5, _INCHES * height / width + 1.0), layout="compressed")
    axes = figure.add_subplot()
    axes.set(xlabel="u (px)", ylabel="v (px)", aspect="equal", xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5))
    cell = max(width, height) / _CELLS
    columns, rows = max(1, round(width / cell)), max(1, round(height / cell))
    edges = np.linspace(-0.5, width - 0.5, columns + 1), np.linspace(-0.5, height - 0.5, rows + 1)
    counts, *_ = np.histogram2d(pixels[used, 0], pixels[used, 1], bins=edges)
    covered = np.where(counts.T > 0.0, counts.T, np.nan)
    drawn = axes.pcolormesh(*edges, covered, cmap=COUNT, vmin=0.0, vmax=max(1.0, 2.0 * float(counts.max())))
    axes.set_facecolor("mistyrose")
    figure.colorbar(
        drawn,
        ax=axes,
        label="points in the cell (red: none)",
        shrink=0.8,
        ticks=MaxNLocator(integer=True),
        boundaries=np.linspace(0.0, max(1.0, float(counts.max())), 100),
    )
    magnification = _ARROW * width / max(rms, 1e-9)
    for mask, colour, label in ((used, "black", "residual"), (~used, "red", "left out")):
        if mask.any():
            axes.quiver(
                *pixels[mask].T,
                *residuals[mask].T,
                color=colour,
                angles="xy",
                scale_units="xy",
                scale=1.0 / magnification,
                width=0.0012,
                label=f"{label} ({mask.sum()} points)",
            )
    axes.plot(*principal_point, "+", color="tab:orange", markersize=14, label="principal point")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.07), ncols=3, fontsize="small", frameon=False)
    axes.set_title(f"{title}, {rms:.3f} px rms, arrows {magnification:.0f} times enlarged")
    return figure
