"""Least squares over the intrinsic parameters and the poses of all the views, and their covariance.

Levenberg-Marquardt on the pixels' distances (Zhang, "A flexible new technique for camera calibration", 2000), with the
projection and its derivatives from OpenCV. Its own minimiser cannot free the two prism coefficients alone, nor weigh
points, and gives no covariance.
"""

from dataclasses import dataclass, replace

import numpy as np

from fedic._types import Floats
from fedic.calibration.lens import COEFFICIENTS, Lens
from fedic.calibration.normal_equations import NormalEquations
from fedic.errors import CameraError

__all__ = ["Bundle", "Estimate", "Observation"]

_CORRECTION = 1e-5
"""The minimum is found when a correction is below this fraction of a standard deviation."""
_IMMATERIAL = 1e-3
"""Likewise where a step does not lower the cost: so close to the minimum that is rounding."""
_EXACT_PX = 1e-8
_STUCK_DAMPING = 1e12
_LARGEST_CONDITION = 1e12


@dataclass(frozen=True, eq=False)
class Observation:
    """The points of the target found in one view.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        Where they are on the target.
    pixels : ndarray, shape (n, 2)
        Where they are seen.
    """

    points: Floats
    pixels: Floats


@dataclass(frozen=True, eq=False)
class Estimate:
    """Values of all the unknowns.

    Attributes
    ----------
    intrinsics : ndarray, shape (p,)
        Of `Lens.parameters`.
    rotations : ndarray, shape (n, 3, 3)
        From the target to the camera, one per view.
    translations : ndarray, shape (n, 3)
        One per view.
    """

    intrinsics: Floats
    rotations: Floats
    translations: Floats

    def of(self, views: list[int]) -> "Estimate":
        """Return the estimate of some of the views."""
        return replace(self, rotations=self.rotations[views], translations=self.translations[views])

    def moved(self, step: Floats) -> "Estimate":
        """Return the estimate moved by a step: intrinsics, then rotation about the camera's axes and translation."""
        import cv2

        size = len(self.intrinsics)
        poses = step[size:].reshape(-1, 6)
        turns = np.array([cv2.Rodrigues(pose[:3])[0] for pose in poses])
        return Estimate(self.intrinsics + step[:size], turns @ self.rotations, self.translations + poses[:, 3:])


class Bundle:
    """The least-squares problem of some views.

    Parameters
    ----------
    lens : Lens
        Its model.
    observations : list of Observation
        One per view.
    weights : list of ndarray, shape (n,), optional
        Of the points of each view; one each if not given, and a point of weight zero counts for nothing.
    """

    def __init__(self, lens: Lens, observations: list[Observation], weights: list[Floats] | None = None) -> None:
        self._lens = lens
        self._observations = observations
        self._weights = weights or [np.ones(len(each.points)) for each in observations]

    def residuals(self, estimate: Estimate) -> list[Floats]:
        """Return seen minus projected pixels, (n, 2) for each view."""
        return [self._linearised(estimate, view, derivatives=False)[0] for view in range(len(self._observations))]

    def minimise(self, estimate: Estimate, max_iterations: int) -> tuple[Estimate, bool]:
        """Move an estimate to the minimum; also say whether it was reached."""
        equations, cost = self._normal_equations(estimate)
        damping = 1e-3
        for _ in range(max_iterations):
            try:
                newton, correction = equations.step(0.0)
                step, _ = equations.step(damping)
            except np.linalg.LinAlgError:
                return estimate, False
            noise = max(np.sqrt(cost / max(self.freedom, 1)), _EXACT_PX)
            deviations = np.sqrt(max(correction, 0.0)) / noise
            if deviations <= _CORRECTION:
                return estimate.moved(newton), True
            trial = estimate.moved(step)
            if self._cost(trial) < cost:
                estimate, damping = trial, max(damping / 10.0, 1e-12)
                equations, cost = self._normal_equations(estimate)
            elif deviations <= _IMMATERIAL:
                return estimate, True
            else:
                damping *= 10.0
                if damping > _STUCK_DAMPING:
                    return estimate, False
        return estimate, False

    @property
    def freedom(self) -> int:
        """Number of measured coordinates less the number of unknowns."""
        counted = sum(int(np.count_nonzero(weights)) for weights in self._weights)
        return 2 * counted - len(self._lens.parameters) - 6 * len(self._observations)

    def covariance(self, estimate: Estimate) -> Floats:
        """Return the covariance of all unknowns at the minimum, in the order of `Estimate.moved`.

        The inverse of the normal matrix times the variance of a coordinate, estimated from the residuals.

        Raises
        ------
        CameraError
            If the views leave some combination of the unknowns free.
        """
        equations, cost = self._normal_equations(estimate)
        if self.freedom <= 0 or not equations.condition < _LARGEST_CONDITION:
            raise CameraError("The views do not determine the parameters of the camera.")
        return equations.inverse() * (cost / self.freedom)

    def _cost(self, estimate: Estimate) -> float:
        costs = [
            float((weights * (residual**2).sum(axis=1))[weights > 0.0].sum())
            for weights, residual in zip(self._weights, self.residuals(estimate), strict=True)
        ]
        total = sum(costs)
        return total if np.isfinite(total) and self._in_front(estimate) else np.inf

    def _in_front(self, estimate: Estimate) -> bool:
        posed = zip(self._observations, estimate.rotations, estimate.translations, strict=True)
        return bool(estimate.intrinsics[:2].min() > 0.0) and all(
            ((each.points @ rotation.T + translation)[:, 2] > 0.0).all() for each, rotation, translation in posed
        )

    def _normal_equations(self, estimate: Estimate) -> tuple[NormalEquations, float]:
        size, count = len(self._lens.parameters), len(self._observations)
        products = np.empty((count, size + 6, size + 6))
        gradients = np.empty((count, size + 6))
        cost = 0.0
        for view, weights in enumerate(self._weights):
            residual, jacobian = self._linearised(estimate, view)
            rows = (np.sqrt(weights)[:, np.newaxis, np.newaxis] * jacobian).reshape(-1, size + 6)
            values = (np.sqrt(weights)[:, np.newaxis] * residual).ravel()
            products[view], gradients[view] = rows.T @ rows, rows.T @ values
            cost += float(values @ values)
        return NormalEquations(products, gradients, size), cost

    def _linearised(self, estimate: Estimate, view: int, *, derivatives: bool = True) -> tuple[Floats, Floats]:
        """Return the residuals (n, 2) of a view and the derivatives (n, 2, p + 6) of its projections."""
        import cv2

        seen = self._observations[view]
        matrix, distortion = self._lens.split(estimate.intrinsics)
        turned = seen.points @ estimate.rotations[view].T
        rest = np.zeros(3)
        pixels, slopes = cv2.projectPoints(turned + estimate.translations[view], rest, rest, matrix, distortion)
        residual = seen.pixels - pixels.reshape(-1, 2)
        if not derivatives:
            return residual, np.empty(0)
        slopes = slopes.reshape(len(turned), 2, -1)
        of_position = slopes[:, :, 3:6]
        of_rotation = np.cross(turned[:, np.newaxis, :], of_position)
        chosen = [6, 7, 8, 9, *(10 + COEFFICIENTS[name] for name in self._lens.coefficients)]
        return residual, np.concatenate([slopes[:, :, chosen], of_rotation, of_position], axis=2)
