"""Variance of the noise against the grey level: photon transfer."""

from dataclasses import dataclass

import numpy as np

from fedic._internal.types import Floats

__all__ = ["GreyLine", "fit_grey_line"]

_BINS = 20
_FEWEST = 100
"""Pixels of a bin."""
_ROUNDS = 3


@dataclass(frozen=True)
class GreyLine:
    """A straight line through the variances of bins of equal number.

    Attributes
    ----------
    greys, variances, errors : ndarray, shape (bins,)
        Mean grey level, variance and its standard error of each bin.
    slope, intercept, slope_error, intercept_error : float
        The line and its standard errors; NaN if the grey levels do not span one.
    """

    greys: Floats
    variances: Floats
    errors: Floats
    slope: float
    intercept: float
    slope_error: float
    intercept_error: float


def fit_grey_line(grey: Floats, variance: Floats) -> GreyLine:
    """Fit a line to the variance of pixels against their grey level.

    Parameters
    ----------
    grey : ndarray, shape (n,)
        Grey level of each pixel, the mean of the images.
    variance : ndarray, shape (n,)
        Unbiased variance of each pixel.

    Returns
    -------
    GreyLine
        Weighted by the scatter that the line itself predicts: weights from the variance of a bin would favour bins that
        are low by chance.
    """
    count = max(1, min(_BINS, len(grey) // _FEWEST))
    parts = np.array_split(np.argsort(grey, kind="stable"), count)
    greys = np.array([grey[part].mean() for part in parts])
    variances = np.array([variance[part].mean() for part in parts])
    errors = np.array([variance[part].std(ddof=1) / np.sqrt(len(part)) for part in parts])
    if count < 3 or np.ptp(greys) <= 4.0 * np.sqrt(variances.mean()):
        # What spans the bins is the noise itself.
        return GreyLine(greys, variances, errors, np.nan, np.nan, np.nan, np.nan)
    relative = errors.mean() / variances.mean()
    centre = float(greys.mean())
    columns = np.column_stack([np.ones(count), greys - centre])
    scatter = np.full(count, relative * variances.mean())
    for _ in range(_ROUNDS):
        weights = 1.0 / scatter**2
        normal = columns.T @ (weights[:, np.newaxis] * columns)
        level, slope = np.linalg.solve(normal, columns.T @ (weights * variances))
        scatter = relative * np.maximum(level + slope * (greys - centre), 0.05 * variances.mean())
    covariance = np.linalg.inv(normal)
    turn = np.array([1.0, -centre])
    return GreyLine(
        greys,
        variances,
        errors,
        float(slope),
        float(level - centre * slope),
        float(np.sqrt(covariance[1, 1])),
        float(np.sqrt(turn @ covariance @ turn)),
    )
