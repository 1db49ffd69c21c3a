"""Robust weights of residuals and robust estimates of their standard deviation."""

import numpy as np

from fedic._internal.types import Floats

__all__ = ["cauchy_weights", "deviation_of_lengths", "deviation_of_residuals", "tukey_weights"]

_CAUCHY = 2.385
_TUKEY = 4.685
"""Tuning constants: an efficiency of 95 % for Gaussian noise."""
_MEDIAN_OF_NORMAL = 0.6745
"""Median absolute value of a Gaussian variable of deviation one."""
_MEDIAN_OF_RAYLEIGH = float(np.sqrt(2.0 * np.log(2.0)))
"""Median length of a Gaussian vector of two components of deviation one."""


def cauchy_weights(ratios: Floats) -> Floats:
    """Return the weights of Cauchy's function, positive for all residuals.

    Parameters
    ----------
    ratios : ndarray
        Residuals in standard deviations.

    Returns
    -------
    ndarray
        Weights from 0 to 1.
    """
    weights: Floats = 1.0 / (1.0 + (ratios / _CAUCHY) ** 2)
    return weights


def tukey_weights(ratios: Floats) -> Floats:
    """Return the weights of Tukey's biweight, zero beyond 4.685 standard deviations.

    Parameters
    ----------
    ratios : ndarray
        Residuals in standard deviations.

    Returns
    -------
    ndarray
        Weights from 0 to 1.
    """
    weights: Floats = np.maximum(1.0 - (ratios / _TUKEY) ** 2, 0.0) ** 2
    return weights


def deviation_of_residuals(residuals: Floats) -> float:
    """Estimate the standard deviation of residuals from their median absolute value; infinite without any."""
    return float(np.median(np.abs(residuals))) / _MEDIAN_OF_NORMAL if len(residuals) else np.inf


def deviation_of_lengths(lengths: Floats) -> float:
    """Estimate the standard deviation of a component of plane residuals from the median of their lengths."""
    return float(np.median(lengths)) / _MEDIAN_OF_RAYLEIGH
