"""Least squares over the intrinsic parameters and the poses of all the views, and their covariance.

Levenberg-Marquardt on the pixels' distances (Zhang, "A flexible new technique for camera calibration", 2000). OpenCV's
own minimiser cannot free the two prism coefficients alone, nor weigh points, takes no other lens, and gives no
covariance.
"""

from dataclasses import dataclass, replace

import numpy as np

from fedic._internal.types import Floats
from fedic.calibration._adjustment.normal_equations import NormalEquations
from fedic.calibration.lenses import Lens
from fedic.calibration.observation import Observation
from fedic.errors import CameraError

__all__ = ["Bundle", "Estimate"]

_IMMATERIAL = 1e-3
"""Likewise where a step does not lower the cost: so close to the minimum that is rounding."""
_EXACT_PX = 1e-8
_AHEAD = 0.1
"""Part of a step over which the curvature along it is seen."""
_STUCK_DAMPING = 1e12
_LARGEST_CONDITION = 1e12
_OPEN = "The views do not determine the parameters of the camera."


@dataclass(frozen=True, eq=False)
class Estimate:
    """Values of all the unknowns.

    Attributes
    ----------
    intrinsics : ndarray, shape (p,)
        Of the unknowns of the `Lens`.
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
        return [self._linearised(estimate, view)[0] for view in range(len(self._observations))]

    def minimise(self, estimate: Estimate, max_iterations: int) -> tuple[Estimate, bool]:
        """Move an estimate to the minimum; also say whether it was reached."""
        equations = self._normal_equations(estimate)
        damping = self._lens.first_damping
        for _ in range(max_iterations):
            try:
                newton, correction = equations.step(0.0)
                step = self._bent(estimate, equations, damping)
            except np.linalg.LinAlgError:
                return estimate, False
            noise = max(np.sqrt(equations.cost / max(self.freedom, 1)), _EXACT_PX)
            deviations = np.sqrt(max(correction, 0.0)) / noise
            if deviations <= self._lens.tolerance:
                return estimate.moved(newton), True
            trial = estimate.moved(step)
            if self._cost(trial) < equations.cost:
                estimate, damping = trial, max(damping / 10.0, 1e-12)
                equations = self._normal_equations(estimate)
            elif deviations <= _IMMATERIAL:
                return estimate, True
            else:
                damping *= 10.0
                if damping > _STUCK_DAMPING:
                    return estimate, False
        return estimate, False

    def _bent(self, estimate: Estimate, equations: NormalEquations, damping: float) -> Floats:
        """Return a step, bent as the projections curve along it (Transtrum and Sethna, 2012).

        Where the views hardly determine a combination of the unknowns, the minimum lies far along a narrow curved
        valley, which straight steps follow slowly.
        """
        step, _ = equations.step(damping)
        ahead = self.residuals(estimate.moved(_AHEAD * step))
        known = zip(self._weights, ahead, equations.residuals, equations.changes(step), strict=True)
        curves = [
            2.0 / _AHEAD * (((np.sqrt(weights)[:, np.newaxis] * after).ravel() - before) / _AHEAD + straight)
            for weights, after, before, straight in known
        ]
        if not all(np.isfinite(curve).all() for curve in curves):
            return step
        bend, _ = equations.step_to(damping, curves)
        return step + 0.5 * bend if np.linalg.norm(bend) <= np.linalg.norm(step) else step

    @property
    def freedom(self) -> int:
        """Number of measured coordinates less the number of unknowns, as if there were no penalty."""
        counted = sum(int(np.count_nonzero(weights)) for weights in self._weights)
        return 2 * counted - self._lens.size - 6 * len(self._observations)

    def covariance(self, estimate: Estimate) -> Floats:
        """Return the covariance of all unknowns at the minimum, in the order of `Estimate.moved`.

        The inverse of the normal matrix times the variance of a coordinate, estimated from the residuals.

        Raises
        ------
        CameraError
            If the views leave some combination of the unknowns free.
        """
        equations = self._normal_equations(estimate)
        freedom, cost = float(self.freedom), equations.cost
        if not equations.condition < _LARGEST_CONDITION:
            raise CameraError(_OPEN)
        if self._lens.penalty is not None:
            freedom += equations.stiffened(self._lens.penalty)
            cost -= float(estimate.intrinsics @ self._lens.penalty @ estimate.intrinsics)
        if freedom <= 0:
            raise CameraError(_OPEN)
        return equations.inverse() * (cost / freedom)

    def eliminated(self, estimate: Estimate, view: int) -> tuple[Floats, Floats, float]:
        """Return what a view says of the intrinsic parameters, its pose free: matrix, right-hand side and cost."""
        equations = NormalEquations(self._lens.size)
        equations.add(*self._rows(estimate, view))
        return equations.eliminated()

    def _cost(self, estimate: Estimate) -> float:
        costs = [
            float((weights * (residual**2).sum(axis=1))[weights > 0.0].sum())
            for weights, residual in zip(self._weights, self.residuals(estimate), strict=True)
        ]
        total = sum(costs)
        if self._lens.penalty is not None:
            total += float(estimate.intrinsics @ self._lens.penalty @ estimate.intrinsics)
        return total if np.isfinite(total) and self._in_front(estimate) else np.inf

    def _in_front(self, estimate: Estimate) -> bool:
        posed = zip(self._observations, estimate.rotations, estimate.translations, strict=True)
        return bool(estimate.intrinsics[:2].min() > 0.0) and all(
            ((each.points @ rotation.T + translation)[:, 2] > 0.0).all() for each, rotation, translation in posed
        )

    def _normal_equations(self, estimate: Estimate) -> NormalEquations:
        equations = NormalEquations(self._lens.size, self._lens.penalty, estimate.intrinsics)
        for view in range(len(self._observations)):
            equations.add(*self._rows(estimate, view))
        return equations

    def _rows(self, estimate: Estimate, view: int) -> tuple[Floats, Floats]:
        """Return the weighted derivatives (2 n, p + 6) of the projections in a view, and the residuals (2 n,)."""
        residual, jacobian = self._linearised(estimate, view)
        weights = np.sqrt(self._weights[view])
        rows = (weights[:, np.newaxis, np.newaxis] * jacobian).reshape(2 * len(weights), -1)
        return rows, (weights[:, np.newaxis] * residual).ravel()

    def _linearised(self, estimate: Estimate, view: int) -> tuple[Floats, Floats]:
        """Return the residuals (n, 2) of a view and the derivatives (n, 2, p + 6) of its projections."""
        seen = self._observations[view]
        turned = seen.points @ estimate.rotations[view].T
        positions = turned + estimate.translations[view]
        pixels, of_values, of_position = self._lens.linearised(estimate.intrinsics, positions)
        of_rotation = np.cross(turned[:, np.newaxis, :], of_position)
        return seen.pixels - pixels, np.concatenate([of_values, of_rotation, of_position], axis=2)
