"""Variance of the noise against the grey level."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fedic._internal.types import Floats

__all__ = ["draw_grey_line"]


def draw_grey_line(
    greys: Floats, variances: Floats, errors: Floats, line: tuple[float, float], *, title: str, axes: Axes | None
) -> Axes:
    """Draw the variance of the noise against the grey level, with the line through it.

    Parameters
    ----------
    greys, variances, errors : ndarray, shape (n,)
        Mean grey level, variance and its standard error of each bin.
    line : (float, float)
        Intercept and slope; NaN if there is no line.
    title : str
        Title.
    axes : Axes, optional
        Where to draw; those of a new figure if None.

    Returns
    -------
    Axes
        The axes.
    """
    if axes is None:
        axes = Figure(figsize=(7.0, 4.8), layout="constrained").add_subplot()
    axes.set(xlabel="grey level", ylabel="variance of the noise (grey levels squared)", title=title)
    if not len(greys):
        axes.text(0.5, 0.5, "not measured", ha="center", va="center", transform=axes.transAxes)
        return axes
    label = "bins of as many pixels, two standard errors"
    axes.errorbar(greys, variances, 2.0 * errors, fmt="o", ms=4, capsize=2, color="tab:blue", label=label)
    intercept, slope = line
    if np.isfinite(slope):
        ends = np.array([greys.min(), greys.max()])
        axes.plot(ends, intercept + slope * ends, color="black", label=f"{intercept:.3g} + {slope:.3g} grey level")
    axes.set_ylim(bottom=0.0)
    axes.grid(visible=True, alpha=0.25)
    axes.legend(loc="upper left", fontsize="small")
    return axes
