"""Fit of a camera to the points of several views, without outliers.

The noise ``s`` of a point is estimated robustly, from the median distance between measured and projected points, but at
least 0.02 px, the repeatability of the detection. If some point is further than ``6 s`` (a fraction of 2e-8 of Gaussian
noise), the fit is repeated with Cauchy weights, which such points hardly influence. A view whose own noise is above ``3
s``, or with more than a fifth of its points beyond ``6 s``, is then rejected; single points beyond ``6 s`` are left
out. The last fit is plain least squares on the rest.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fedic._internal.robust_weights import cauchy_weights, deviation_of_lengths
from fedic._internal.types import Floats
from fedic.calibration._adjustment.bundle import Bundle, Estimate
from fedic.calibration._adjustment.correlation import correlation_factor
from fedic.calibration._adjustment.start import initial_estimate, pose_of
from fedic.calibration.lenses import Lens
from fedic.calibration.observation import Observation
from fedic.errors import CameraError

__all__ = ["Fit", "fit", "point_weights"]

_FAR_POINT = 6.0
_NOISY_VIEW = 3.0
_SPOILT_VIEW = 0.2
_SMALLEST_NOISE = 0.02
_ROUNDS = 30
_MAX_ITERATIONS = 500
_ROBUST_ITERATIONS = 10
_FEWEST_VIEWS = 2


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit.

    Attributes
    ----------
    lens : Lens
        Lens model.
    estimate : Estimate
        Minimum; the poses of rejected views are the best ones for the camera of the others.
    covariance : ndarray, shape (p + 6 n, p + 6 n)
        Covariance of the intrinsic parameters, then, for each accepted view, of a rotation about the camera's axes
        (radians) and of the translation; enlarged where the residuals of neighbouring points are correlated.
    accepted : list of int
        Accepted views.
    reasons : dict of int to str
        Reasons of the rejections.
    used : list of ndarray of bool
        Points used in each view.
    initial_errors, final_errors : ndarray, shape (number of views,)
        Root mean square distance of the points in pixels, before the fit and after it.
    residuals : list of ndarray, shape (n, 2)
        Measured minus projected image points of each view.
    """

    lens: Lens
    estimate: Estimate
    covariance: Floats
    accepted: list[int]
    reasons: dict[int, str]
    used: list[NDArray[np.bool_]]
    initial_errors: Floats
    final_errors: Floats
    residuals: list[Floats]


def fit(
    lens: Lens, observations: list[Observation], image_size: tuple[int, int], estimate: Estimate | None = None
) -> Fit:
    """Fit a camera.

    Parameters
    ----------
    lens : Lens
        Lens model.
    observations : list of Observation
        One per view.
    image_size : (int, int)
        Width and height in pixels.
    estimate : Estimate, optional
        Start; by default from `initial_estimate`.

    Returns
    -------
    Fit
        The minimum.

    Raises
    ------
    CameraError
        If fewer than two views remain, they do not determine the parameters, or the fit does not converge.
    """
    _check_count(len(observations), "seen", {})
    estimate = estimate or initial_estimate(lens, observations, image_size)
    every = Bundle(lens, observations)
    initial_errors = _rms(every.distances(estimate))
    estimate = every.minimize(estimate, _MAX_ITERATIONS).estimate
    lengths = _lengths(every.distances(estimate))
    if any((length > _FAR_POINT * _noise(lengths)).any() for length in lengths):
        estimate = _robust(lens, observations, estimate)

    accepted, reasons = list(range(len(observations))), dict[int, str]()
    used = [np.ones(len(each.points), dtype=bool) for each in observations]
    for _ in range(_ROUNDS):
        before = [mask.copy() for mask in used], len(accepted)
        lengths = _lengths(every.distances(estimate))
        noise = _noise([lengths[view] for view in accepted])
        for view in list(accepted):
            used[view] = lengths[view] <= _FAR_POINT * noise
            if reason := _fault(lengths[view], used[view], noise):
                accepted.remove(view)
                reasons[view] = reason
        _check_count(len(accepted), "left", reasons)
        estimate = _refitted(lens, observations, estimate, accepted, used)
        if len(accepted) == before[1] and all(map(np.array_equal, used, before[0])):
            break

    weights = [used[view].astype(np.float64) for view in accepted]
    bundle = Bundle(lens, [observations[view] for view in accepted], weights)
    residuals = every.distances(estimate)
    final = [
        residual[mask] if view in accepted else residual
        for view, (residual, mask) in enumerate(zip(residuals, used, strict=True))
    ]
    covariance = bundle.covariance(estimate.of(accepted)) * correlation_factor(
        [observations[view].points[used[view]] for view in accepted], [final[view] for view in accepted]
    )
    return Fit(lens, estimate, covariance, accepted, reasons, used, initial_errors, _rms(final), residuals)


def _refitted(
    lens: Lens,
    observations: list[Observation],
    estimate: Estimate,
    accepted: list[int],
    used: list[NDArray[np.bool_]],
) -> Estimate:
    """Return the least-squares fit to the accepted views; the poses of the others are fitted to the new camera."""
    weights = [used[view].astype(np.float64) for view in accepted]
    bundle = Bundle(lens, [observations[view] for view in accepted], weights)
    minimum = bundle.minimize(estimate.of(accepted), _MAX_ITERATIONS)
    if not minimum.converged:
        raise CameraError(
            f"The fit did not converge in {_MAX_ITERATIONS} iterations: the views do not determine some parameter, or "
            "the points found are not those of one flat target."
        )
    kept = minimum.estimate
    rotations, translations = estimate.rotations.copy(), estimate.translations.copy()
    rotations[accepted], translations[accepted] = kept.rotations, kept.translations
    for view in set(range(len(observations))) - set(accepted):
        rotations[view], translations[view] = pose_of(observations[view], lens, kept.intrinsics)
    return Estimate(kept.intrinsics, rotations, translations)


def _robust(lens: Lens, observations: list[Observation], estimate: Estimate) -> Estimate:
    """Return the fit with Cauchy weights, from the least-squares fit."""
    previous = np.inf
    for _ in range(_ROUNDS):
        residuals = Bundle(lens, observations).distances(estimate)
        noise = _noise(_lengths(residuals))
        if abs(noise - previous) <= 1e-3 * noise:
            break
        previous = noise
        bundle = Bundle(lens, observations, point_weights(residuals))
        estimate = bundle.minimize(estimate, _ROBUST_ITERATIONS).estimate
    return estimate


def point_weights(residuals: list[Floats]) -> list[Floats]:
    """Return Cauchy weights (n,) of the points of each view from their residuals (n, 2)."""
    lengths = _lengths(residuals)
    noise = _noise(lengths)
    return [cauchy_weights(length / noise) for length in lengths]


def _fault(lengths: Floats, used: NDArray[np.bool_], noise: float) -> str:
    """Return the reason for rejecting a view; empty if it is accepted."""
    own = _noise([lengths])
    if own > _NOISY_VIEW * noise:
        return (
            f"the noise of its points is {own:.2g} px, more than {_NOISY_VIEW:g} times the {noise:.2g} px of all "
            "views: blurred, moved, or wrongly detected"
        )
    if (~used).sum() > _SPOILT_VIEW * len(used):
        return (
            f"{(~used).sum()} of its {len(used)} points are more than {_FAR_POINT * noise:.2g} px away "
            f"({_FAR_POINT:g} times the noise of all views)"
        )
    return ""


def _check_count(count: int, state: str, reasons: dict[int, str]) -> None:
    if count >= _FEWEST_VIEWS:
        return
    causes = "".join(f"\n  {reason}" for reason in sorted(set(reasons.values())))
    raise CameraError(
        f"The target was {state} in {count} view{'s' * (count != 1)}, and the camera needs at least {_FEWEST_VIEWS}, "
        f"better 10 to 20, from different directions.{causes}"
        if state == "seen"
        else f"{count} of the views fit together, and the camera needs at least {_FEWEST_VIEWS}; the others:{causes}"
    )


def _lengths(residuals: list[Floats]) -> list[Floats]:
    """Return the distances in pixels; infinite for a point that cannot be projected."""
    distances = [np.linalg.norm(residual, axis=1) for residual in residuals]
    return [np.where(np.isfinite(distance), distance, np.inf) for distance in distances]


def _noise(lengths: list[Floats]) -> float:
    return max(deviation_of_lengths(np.concatenate(lengths)), _SMALLEST_NOISE)


def _rms(residuals: list[Floats]) -> Floats:
    return np.array([np.sqrt((residual**2).sum(axis=1).mean()) for residual in residuals])
