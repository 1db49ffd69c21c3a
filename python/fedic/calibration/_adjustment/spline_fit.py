"""Fit of a non-parametric lens."""

from dataclasses import replace

import numpy as np

from fedic._internal.types import Floats
from fedic.calibration._adjustment.bundle import Bundle, Estimate
from fedic.calibration._adjustment.fit import Fit, fit, point_weights
from fedic.calibration._adjustment.smoothing import select_smoothing
from fedic.calibration.lenses import RADIAL, SplineLens
from fedic.calibration.observation import Observation
from fedic.errors import CameraError

__all__ = ["fit_spline"]

_FEWEST_POINTS = 200
_FIRST_SMOOTHING = 1e-6
"""A small value, so that the estimate is close to that of any smoothing chosen afterwards."""
_FIRST_ITERATIONS = 6


def fit_spline(name: str, observations: list[Observation], image_size: tuple[int, int]) -> Fit:
    """Fit a camera with a non-parametric lens.

    Parameters
    ----------
    name : str
        ``"spline"`` or ``"inverse-spline"``.
    observations : list of Observation
        One per view.
    image_size : (int, int)
        Width and height in pixels.

    Returns
    -------
    Fit
        The minimum. Its initial errors are those before the first fit.

    Raises
    ------
    CameraError
        If there are fewer than 200 points, they do not determine the camera, or the fit does not converge.
    """
    count = sum(len(each.points) for each in observations)
    if count < _FEWEST_POINTS:
        raise CameraError(
            f"A {name} lens is determined by the points alone and needs at least {_FEWEST_POINTS}, better a few "
            f"thousand, all over the image; the views have {count}. Take more views, or use 'radial1'."
        )
    first = fit(RADIAL, observations, image_size)
    kept = [observations[view] for view in first.accepted]
    weights = point_weights([first.residuals[view] for view in first.accepted])
    pixels = np.concatenate([each.pixels for each in kept])
    camera = RADIAL.camera(first.estimate.intrinsics, np.eye(3), np.zeros(3))
    near = first.estimate.of(first.accepted)
    for _ in range(2):  # the first field changes the poses, and with them the undistorted points
        lens = replace(SplineLens.over(name, _undistorted(kept, near), pixels, camera), smoothing=_FIRST_SMOOTHING)
        start = replace(near, intrinsics=np.concatenate([near.intrinsics[:4], np.zeros(lens.size - 4)]))
        bundle = Bundle(lens, kept, weights)
        near = bundle.minimize(start, _FIRST_ITERATIONS).estimate
    lens = select_smoothing(lens, bundle, near)

    rotations, translations = first.estimate.rotations.copy(), first.estimate.translations.copy()
    rotations[first.accepted], translations[first.accepted] = near.rotations, near.translations
    found = fit(lens, observations, image_size, Estimate(near.intrinsics, rotations, translations))
    return replace(found, initial_errors=first.initial_errors)


def _undistorted(seen: list[Observation], estimate: Estimate) -> Floats:
    """Return the undistorted normalised image points (n, 2) of all views."""
    poses = zip(seen, estimate.rotations, estimate.translations, strict=True)
    positions = np.concatenate([each.points @ rotation.T + translation for each, rotation, translation in poses])
    normalised: Floats = positions[:, :2] / positions[:, 2:]
    return normalised
