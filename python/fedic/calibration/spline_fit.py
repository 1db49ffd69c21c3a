"""The fit of a non-parametric lens."""

from dataclasses import replace

import numpy as np

from fedic._types import Floats
from fedic.calibration.bundle import Bundle, Estimate, Observation
from fedic.calibration.fit import Fit, fit
from fedic.calibration.lens import BROWN
from fedic.calibration.smoothing import smoothed
from fedic.calibration.spline_lens import SplineLens
from fedic.errors import CameraError

__all__ = ["fit_spline"]

_FEWEST_POINTS = 200
_FIRST_SMOOTHING = 1e-6
"""Little, so that whatever is chosen then is near."""
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
        The minimum. Its initial errors are those before any fit.

    Raises
    ------
    CameraError
        If there are fewer than 200 points, they do not determine the camera, or the fit does not converge.
    """
    count = sum(len(each.points) for each in observations)
    if count < _FEWEST_POINTS:
        raise CameraError(
            f"A {name} lens takes its shape from the points alone and needs at least {_FEWEST_POINTS}, better a few "
            f"thousand, all over the image; the views have {count}. Take more views, or 'radial1'."
        )
    first = fit(BROWN, observations, image_size)
    retinal = [_retinal(first, observations[view], view)[first.used[view]] for view in first.accepted]
    lens = SplineLens.over(name, np.concatenate(retinal), float(first.estimate.intrinsics[:2].max()))
    poses = first.estimate.rotations, first.estimate.translations
    estimate = Estimate(np.concatenate([first.estimate.intrinsics[:4], np.zeros(lens.size - 4)]), *poses)

    kept = [observations[view] for view in first.accepted]
    weights = [first.used[view].astype(np.float64) for view in first.accepted]
    lens = replace(lens, smoothing=_FIRST_SMOOTHING)
    bundle = Bundle(lens, kept, weights)
    near, _ = bundle.minimise(estimate.of(first.accepted), _FIRST_ITERATIONS)
    lens = smoothed(lens, bundle, len(kept), near)

    estimate.rotations[first.accepted], estimate.translations[first.accepted] = near.rotations, near.translations
    found = fit(lens, observations, image_size, replace(estimate, intrinsics=near.intrinsics))
    return replace(found, initial_errors=first.initial_errors)


def _retinal(fitted: Fit, seen: Observation, view: int) -> Floats:
    """Return the undistorted retinal points (n, 2) of a view."""
    estimate = fitted.estimate
    positions = seen.points @ estimate.rotations[view].T + estimate.translations[view]
    retinal: Floats = positions[:, :2] / positions[:, 2:]
    return retinal
