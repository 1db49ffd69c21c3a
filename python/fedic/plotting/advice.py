"""Standard deviations against the size of the elements."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from fedic._internal.types import Floats

__all__ = ["draw_size_curves"]

_STYLES = (("o-", "tab:blue"), ("s--", "tab:orange"), ("^:", "tab:green"))


def draw_size_curves(
    sizes: Floats,
    displacement: Mapping[str, Floats],
    strain: Mapping[str, Floats],
    *,
    targets: tuple[float, float],
    recommended: float,
    title: str,
) -> Figure:
    """Draw standard deviations of displacement and strain against the size of the elements.

    Parameters
    ----------
    sizes : ndarray, shape (k,)
        Sizes, in pixels.
    displacement, strain : mapping of str to ndarray of shape (k,)
        Standard deviations of each component.
    targets : (float, float)
        Of the displacement and of the strains; NaN if there is none.
    recommended : float
        Size that is recommended; NaN if there is none.
    title : str
        Title.

    Returns
    -------
    Figure
        The figure.
    """
    figure = Figure(figsize=(11.0, 4.4), layout="constrained")
    figure.suptitle(title)
    left, right = figure.subplots(1, 2)
    _draw(left, sizes, displacement, targets[0], recommended, "px")
    _draw(right, sizes, strain, targets[1], recommended, "")
    left.set_ylabel("predicted standard deviation of the displacement (px)")
    right.set_ylabel("predicted standard deviation of the strain")
    return figure


def _draw(
    axes: Axes, sizes: Floats, curves: Mapping[str, Floats], target: float, recommended: float, unit: str
) -> None:
    axes.set(xscale="log", yscale="log", xlabel="size of the elements (px)")
    for (name, values), (style, colour) in zip(curves.items(), _STYLES, strict=False):
        axes.plot(sizes, values, style, color=colour, ms=4, label=name)
    if np.isfinite(target):
        axes.axhline(target, color="black", lw=1.0, label=f"target {target:g} {unit}".strip())
    if np.isfinite(recommended):
        axes.axvline(recommended, color="tab:red", lw=1.0, label=f"recommended {recommended:g} px")
    axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xticks([], minor=True)
    axes.grid(visible=True, which="both", alpha=0.25)
    axes.legend(fontsize="small")
