"""The statistics of an assessment, of plain arrays."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fedic._internal.types import Floats
from fedic.results.rigid import fit_rigid_motion

__all__ = [
    "Deviations",
    "PixelSize",
    "deviations",
    "pixel_size",
    "zero_displacement_deviation",
    "zero_strain_deviation",
]


class Deviations(NamedTuple):
    """Statistics of deviations along one axis.

    Attributes
    ----------
    num_readings : int
        Number of readings.
    mean, standard_deviation, largest : float
        Mean, standard deviation (NaN of one reading) and largest magnitude.
    """

    num_readings: int
    mean: float
    standard_deviation: float
    largest: float


class PixelSize(NamedTuple):
    """Size of a pixel on the specimen.

    Attributes
    ----------
    size, uncertainty : float
        In the mesh's unit per pixel, and its standard uncertainty; NaN if it is not known.
    """

    size: float
    uncertainty: float


def zero_displacement_deviation(fields: Sequence[tuple[Floats, Floats]]) -> Floats:
    """Compute the zero displacement deviation, after VDI/VDE 2626.

    Parameters
    ----------
    fields : sequence of (ndarray, ndarray), shape (n, 2)
        Positions and averaged displacements of the squares of each pose.

    Returns
    -------
    ndarray, shape (3,)
        Root mean square over the squares of all poses of the displacement without the rigid motion of its pose: the
        length of the vector (ZD), and the components along x and y. NaN without squares.
    """
    residuals = [fit_rigid_motion(points, displacement).residual for points, displacement in fields if len(points) > 1]
    if not residuals:
        return np.full(3, np.nan)
    squares = (np.concatenate(residuals) ** 2).mean(axis=0)
    return np.asarray(np.sqrt(np.array([squares.sum(), *squares])))


def zero_strain_deviation(strains: Sequence[Floats]) -> Floats:
    """Compute the zero strain deviation, after VDI/VDE 2626.

    Parameters
    ----------
    strains : sequence of ndarray, shape (n, 3)
        Averaged strains ``exx, eyy, exy`` of the squares of each pose.

    Returns
    -------
    ndarray, shape (4,)
        Root mean square over the squares of all poses: over the three components together (ZS), and of each. NaN
        without squares.
    """
    joined = np.concatenate(
        [np.asarray(each, dtype=np.float64).reshape(-1, 3) for each in strains] or [np.empty((0, 3))]
    )
    if not len(joined):
        return np.full(4, np.nan)
    squares = (joined**2).mean(axis=0)
    return np.asarray(np.sqrt(np.array([squares.mean(), *squares])))


def deviations(measured: Floats, given: Floats) -> Deviations:
    """Compare readings with set values along one axis, after EN 4861.

    Parameters
    ----------
    measured, given : ndarray, shape (n,)
        Readings and set values.

    Returns
    -------
    Deviations
        Of ``measured - given``.
    """
    differences = np.asarray(measured, dtype=np.float64) - np.asarray(given, dtype=np.float64)
    count = len(differences)
    return Deviations(
        count,
        float(differences.mean()) if count else np.nan,
        float(differences.std(ddof=1)) if count > 1 else np.nan,
        float(np.abs(differences).max()) if count else np.nan,
    )


def pixel_size(pixels: Floats, given: Floats, set_uncertainty: float = 0.0) -> PixelSize:
    """Estimate the size of a pixel from known translations.

    Parameters
    ----------
    pixels : ndarray, shape (n, 2)
        Measured displacements in the image, in pixels.
    given : ndarray, shape (n, 2)
        Set displacements, in the mesh's unit.
    set_uncertainty : float
        Standard uncertainty of the length of each set displacement.

    Returns
    -------
    PixelSize
        The ratio of the lengths by least squares, whatever the directions of the axes. Its uncertainty has the scatter
        of the readings, NaN of fewer than two, and that of the set displacements.
    """
    read, length = np.linalg.norm(pixels, axis=1), np.linalg.norm(given, axis=1)
    squares = float((length**2).sum())
    if squares == 0.0 or not (read > 0.0).any():
        return PixelSize(np.nan, np.nan)
    scale = float((read * length).sum()) / squares
    if len(read) < 2:
        return PixelSize(1.0 / scale, np.nan)
    scatter = float(((read - scale * length) ** 2).sum()) / (len(read) - 1)
    variance = (scatter + (scale * set_uncertainty) ** 2) / squares
    return PixelSize(1.0 / scale, float(np.sqrt(variance)) / scale**2)
