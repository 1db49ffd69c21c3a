"""The picture of a calibration: residual vectors over the image, and how often each part of it is covered."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from fedic.errors import FedicError

if TYPE_CHECKING:
    from fedic.calibration._result import Calibration

__all__ = ["check_picture", "draw_residuals"]

_INCHES = 8.0
_CELLS = 16
_ARROW = 0.02
"""Length of the arrow of a root mean square residual, in widths of the image."""


def check_picture(path: Path) -> None:
    """Check, before any long work, that a picture can be drawn in a file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    FedicError
        If it is no ``.png`` file.
    """
    if path.suffix.lower() != ".png":
        raise FedicError(f"{path}: the picture is drawn as .png only; change the name.")


def draw_residuals(calibration: "Calibration") -> Figure:
    """Draw the residual vectors, enlarged, and the number of points in each part of the image.

    Parameters
    ----------
    calibration : Calibration
        What to draw.

    Returns
    -------
    Figure
        Save it with `fedic.plotting.fields.save_figure`.
    """
    width, height = calibration.image_size
    accepted = [view for view in calibration.views if view.accepted]
    pixels = np.concatenate([view.pixels for view in accepted])
    residuals = np.concatenate([view.residuals for view in accepted])
    used = np.concatenate([view.used for view in accepted])

    figure = Figure(figsize=(_INCHES + 1.5, _INCHES * height / width + 1.0), layout="compressed")
    axes = figure.add_subplot()
    axes.set(xlabel="u (px)", ylabel="v (px)", aspect="equal", xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5))
    cell = max(width, height) / _CELLS
    columns, rows = max(1, round(width / cell)), max(1, round(height / cell))
    edges = np.linspace(-0.5, width - 0.5, columns + 1), np.linspace(-0.5, height - 0.5, rows + 1)
    counts, *_ = np.histogram2d(pixels[used, 0], pixels[used, 1], bins=edges)
    covered = np.where(counts.T > 0.0, counts.T, np.nan)
    drawn = axes.pcolormesh(*edges, covered, cmap="Blues", vmin=0.0, vmax=max(1.0, 2.0 * float(counts.max())))
    axes.set_facecolor("mistyrose")
    figure.colorbar(
        drawn,
        ax=axes,
        label="points in the cell (red: none)",
        shrink=0.8,
        ticks=MaxNLocator(integer=True),
        boundaries=np.linspace(0.0, max(1.0, float(counts.max())), 100),
    )
    magnification = _ARROW * width / max(calibration.reprojection_error, 1e-9)
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
    axes.plot(*calibration.camera.principal_point, "+", color="tab:orange", markersize=14, label="principal point")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.07), ncols=3, fontsize="small", frameon=False)
    axes.set_title(
        f"{len(accepted)} of {len(calibration.views)} views, {calibration.reprojection_error:.3f} px rms, "
        f"arrows {magnification:.0f} times enlarged"
    )
    return figure
