"""Calibration of a camera from points of a target that are already found."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from fedic._internal.determinacy import LARGEST_RELATIVE_DEVIATION
from fedic.calibration._adjustment.fit import Fit, fit
from fedic.calibration._adjustment.shape import fit_shape
from fedic.calibration._adjustment.spline_fit import fit_spline
from fedic.calibration._adjustment.start import initial_estimate
from fedic.calibration._advice import tilt_advice
from fedic.calibration._build import build_result
from fedic.calibration._result import Calibration
from fedic.calibration.lenses import BROWN, CoefficientLens, parse_lens
from fedic.calibration.observation import Observation
from fedic.errors import CameraError, OptionError

__all__ = ["calibrate_points", "fit_or_explain"]


def calibrate_points(
    points: Sequence[ArrayLike],
    pixels: Sequence[ArrayLike],
    image_size: tuple[int, int],
    distortion: str | Sequence[str] = "radial1",
    *,
    view: int | str | None = None,
) -> Calibration:
    """Calibrate a camera from points found by other means.

    Parameters
    ----------
    points : sequence of array_like, shape (n, 2) or (n, 3)
        Points of a flat target in each view, with Z = 0.
    pixels : sequence of array_like, shape (n, 2)
        Their image points.
    image_size : (int, int)
        Width and height in pixels.
    distortion, view
        See `calibrate`; the views are named ``"image 0"``, ``"image 1"``, ...

    Returns
    -------
    Calibration
        The camera, its uncertainty, and the residuals of each view.

    Raises
    ------
    OptionError
        If the arrays do not fit together, or an argument is malformed.
    CameraError
        If the views do not determine the camera, or the camera found cannot be right.

    Warns
    -----
    CalibrationWarning
        If the target is not as given (see `Calibration.target_shape`), or the camera found is hardly plausible.
    """
    lens = parse_lens(distortion)
    if len(points) != len(pixels):
        raise OptionError(
            f"{len(points)} views have points and {len(pixels)} have pixels; give one of each per view.", "points"
        )
    pairs = enumerate(zip(points, pixels, strict=True))
    seen = [_observation(index, *pair) for index, pair in pairs]
    names = [f"image {index}" for index in range(len(seen))]
    found = list(range(len(seen)))
    final = fit_shape(fit_or_explain(lens, seen, image_size), seen, image_size)
    return build_result(seen, found, names, {}, final, image_size, view)


def _observation(index: int, points: ArrayLike, pixels: ArrayLike) -> Observation:
    where, at = np.asarray(points, dtype=np.float64), np.asarray(pixels, dtype=np.float64)
    if where.ndim == 2 and where.shape[1] == 2:
        where = np.column_stack([where, np.zeros(len(where))])
    if where.ndim != 2 or where.shape[1] != 3 or at.shape != (len(where), 2) or len(where) < 4:
        raise OptionError(
            f"image {index}: points of shape {where.shape} and pixels of shape {at.shape}; give (n, 2) or (n, 3) and "
            "(n, 2), with n at least 4.",
            "points",
        )
    if not (np.isfinite(where).all() and np.isfinite(at).all()) or np.any(where[:, 2] != 0.0):
        raise OptionError(
            f"image {index}: the points must be finite, with Z = 0 on the target, and the pixels finite.", "points"
        )
    return Observation(where, at)


def fit_or_explain(lens: CoefficientLens | str, seen: list[Observation], image_size: tuple[int, int]) -> Fit:
    """Fit a camera; if that fails, add the likely cause in the directions of the views to the message.

    Parameters
    ----------
    lens : CoefficientLens or str
        Lens model, or the name of a non-parametric one.
    seen : list of Observation
        One per view.
    image_size : (int, int)
        Width and height in pixels.

    Returns
    -------
    Fit
        The minimum.

    Raises
    ------
    CameraError
        If the views do not determine the camera, or the fit does not converge.
    """
    try:
        found = fit_spline(lens, seen, image_size) if isinstance(lens, str) else fit(lens, seen, image_size)
        values, deviations = found.estimate.intrinsics[:2], np.sqrt(np.diag(found.covariance)[:2])
        if np.any(deviations > LARGEST_RELATIVE_DEVIATION * values):
            raise CameraError(f"The views do not determine the focal length: {values[0]:.4g} ± {deviations[0]:.2g} px.")
    except (CameraError, np.linalg.LinAlgError) as fault:
        what = str(fault) if isinstance(fault, CameraError) else "The views do not determine the camera."
        raise CameraError(" ".join([what, *_causes(seen, image_size)])) from None
    return found


def _causes(seen: list[Observation], image_size: tuple[int, int]) -> list[str]:
    """Return advice on the directions of the views, as estimated before the fit."""
    try:
        return tilt_advice(initial_estimate(BROWN, seen, image_size).rotations) if len(seen) > 1 else []
    except CameraError:
        return []
