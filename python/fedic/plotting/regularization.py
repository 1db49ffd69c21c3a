"""Residuals over the length of a regularization."""

from typing import Protocol

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator, StrMethodFormatter

from fedic._internal.types import Floats

__all__ = ["draw_regularization_curve"]


class _Curve(Protocol):
    @property
    def lengths(self) -> Floats: ...
    @property
    def left_out_rms(self) -> Floats: ...
    @property
    def left_out_error(self) -> Floats: ...
    @property
    def residual_rms(self) -> Floats: ...
    @property
    def best_length(self) -> float: ...


def draw_regularization_curve(curve: _Curve) -> Figure:
    """Draw the residual at the pixels left out and at those measured with.

    Parameters
    ----------
    curve : RegularizationCurve
        The residuals.

    Returns
    -------
    Figure
        The figure.
    """
    figure = Figure(figsize=(7.0, 4.5), layout="compressed")
    axes = figure.add_subplot()
    axes.errorbar(
        curve.lengths, curve.left_out_rms, yerr=2.0 * curve.left_out_error, fmt="o-", capsize=3, label="pixels left out"
    )
    axes.plot(curve.lengths, curve.residual_rms, "s--", color="grey", label="pixels measured with")
    best = float(np.nanmin(curve.left_out_rms))
    axes.plot(curve.best_length, best, "o", ms=13, mfc="none", mec="red", label=f"best: {curve.best_length:.4g} px")
    axes.set(xscale="log", xlabel="regularization length (px)", ylabel="residual, rms (grey levels)")
    axes.xaxis.set_major_locator(FixedLocator(curve.lengths.tolist()))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:.3g}"))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_title("bars: two standard errors of the difference to the best", fontsize="small")
    axes.legend()
    return figure
