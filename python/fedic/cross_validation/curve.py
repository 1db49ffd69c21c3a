"""Residuals over the length of a regularization."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fedic._internal.types import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["RegularizationCurve"]


@dataclass(frozen=True, eq=False, repr=False)
class RegularizationCurve:
    """Residuals over the length of a regularization.

    Attributes
    ----------
    lengths : ndarray of float, shape (m,)
        Lengths, in pixels, ascending.
    left_out_rms : ndarray of float, shape (m,)
        Root mean square of the residual, in grey levels, at pixels that the measurement did not see; NaN where one of
        the measurements did not converge.
    residual_rms : ndarray of float, shape (m,)
        Root mean square of the residual, in grey levels, at the points that were measured with.
    left_out_error : ndarray of float, shape (m,)
        Standard error of `left_out_rms` relative to that of the best length, in grey levels: zero at the best.
    """

    lengths: Floats
    left_out_rms: Floats
    residual_rms: Floats
    left_out_error: Floats

    @property
    def best_length(self) -> float:
        """Length of the least residual at the pixels left out, in pixels."""
        return float(self.lengths[np.nanargmin(self.left_out_rms)])

    def plot(self) -> "Figure":
        """Draw the residuals over the length.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; its method ``savefig`` writes it.
        """
        from fedic.plotting.regularization import draw_regularization_curve

        return draw_regularization_curve(self)

    def __repr__(self) -> str:
        first, last = self.lengths[0], self.lengths[-1]
        return (
            f"RegularizationCurve({len(self.lengths)} lengths from {first:.4g} to {last:.4g} px, "
            f"best_length={self.best_length:.4g})"
        )
