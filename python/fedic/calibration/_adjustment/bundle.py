"""Least squares over the intrinsic parameters and the poses of all views, and their covariance.

Zhang, "A flexible new technique for camera calibration", 2000. OpenCV's own minimiser cannot free the two prism
coefficients alone, weight points, fit other lenses or give a covariance.
"""

from dataclasses import dataclass, replace

import numpy as np

from fedic._internal.determinacy import LARGEST_CONDITION
from fedic._internal.least_squares import Minimum, minimize
from fedic._internal.types import Floats
from fedic.calibration._adjustment.normal_equations import NormalEquations
from fedic.calibration.lenses import Lens
from fedic.calibration.observation import Observation
from fedic.errors import CameraError

__all__ = ["Bundle", "Estimate"]

_IMMATERIAL = 1e-3
_SMALLEST_NOISE_PX = 1e-8
_UNDETERMINED = "The views do not determine the parameters of the camera."


@dataclass(frozen=True, eq=False)
class Estimate:
    """Values of all unknowns.

    Attributes
    ----------
    intrinsics : ndarray, shape (p,)
        Unknowns of the `Lens`.
    rotations : ndarray, shape (n, 3, 3)
        Rotation from the target to the camera in each view.
    translations : ndarray, shape (n, 3)
        Translation in each view.
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
    """The least-squares problem of some views, a `fedic._internal.least_squares.Problem`.

    Parameters
    ----------
    lens : Lens
        Lens model.
    observations : list of Observation
        One per view.
    weights : list of ndarray, shape (n,), optional
        Weights of the points of each view, one by default; points of weight zero are ignored.
    """

    def __init__(self, lens: Lens, observations: list[Observation], weights: list[Floats] | None = None) -> None:
        self._lens = lens
        self._observations = observations
        self._weights = weights or [np.ones(len(each.points)) for each in observations]

    def minimize(self, estimate: Estimate, max_iterations: int) -> Minimum[Estimate]:
        """Minimise the squared distances from a start."""
        return minimize(
            self,
            estimate,
            tolerance=self._lens.tolerance,
            immaterial=_IMMATERIAL,
            freedom=self.freedom,
            smallest_noise=_SMALLEST_NOISE_PX,
            damping=self._lens.first_damping,
            max_iterations=max_iterations,
        )

    def distances(self, estimate: Estimate) -> list[Floats]:
        """Return measured minus projected pixels, (n, 2) for each view."""
        return [self._linearised(estimate, view)[0] for view in range(len(self._observations))]

    def residuals(self, estimate: Estimate) -> Floats:
        """Return the weighted distances of all views, see `fedic._internal.least_squares.Problem`."""
        pairs = zip(self._weights, self.distances(estimate), strict=True)
        return np.concatenate([(np.sqrt(weights)[:, np.newaxis] * distances).ravel() for weights, distances in pairs])

    def cost(self, estimate: Estimate) -> float:
        """Return the sum of squares and the penalty; infinite if a point lies behind the camera."""
        costs = [
            float((weights * (distances**2).sum(axis=1))[weights > 0.0].sum())
            for weights, distances in zip(self._weights, self.distances(estimate), strict=True)
        ]
        total = sum(costs)
        if self._lens.penalty is not None:
            total += float(estimate.intrinsics @ self._lens.penalty @ estimate.intrinsics)
        return total if np.isfinite(total) and self._in_front(estimate) else np.inf

    def linearize(self, estimate: Estimate) -> NormalEquations:
        """Return the normal equations."""
        equations = NormalEquations(self._lens.size, self._lens.penalty, estimate.intrinsics)
        for view in range(len(self._observations)):
            equations.add(*self._rows(estimate, view))
        return equations

    def move(self, estimate: Estimate, step: Floats) -> Estimate:
        """Return the estimate moved by a step."""
        return estimate.moved(step)

    @property
    def freedom(self) -> int:
        """Number of measured coordinates minus the number of unknowns, regardless of a penalty."""
        counted = sum(int(np.count_nonzero(weights)) for weights in self._weights)
        return 2 * counted - self._lens.size - 6 * len(self._observations)

    def covariance(self, estimate: Estimate) -> Floats:
        """Return the covariance of all unknowns at the minimum, in the order of `Estimate.moved`.

        It is the inverse of the normal matrix times the variance of a coordinate, estimated from the residuals.

        Raises
        ------
        CameraError
            If the views do not determine some combination of the unknowns.
        """
        equations = self.linearize(estimate)
        freedom, cost = float(self.freedom), equations.cost
        if not equations.condition < LARGEST_CONDITION:
            raise CameraError(_UNDETERMINED)
        if self._lens.penalty is not None:
            freedom += equations.stiffened(self._lens.penalty)
            cost -= float(estimate.intrinsics @ self._lens.penalty @ estimate.intrinsics)
        if freedom <= 0:
            raise CameraError(_UNDETERMINED)
        return equations.inverse() * (cost / freedom)

    def eliminated(self, estimate: Estimate, view: int) -> tuple[Floats, Floats, float]:
        """Return matrix, right-hand side and cost of the intrinsic parameters from one view, its pose eliminated."""
        equations = NormalEquations(self._lens.size)
        equations.add(*self._rows(estimate, view))
        return equations.eliminated()

    def _in_front(self, estimate: Estimate) -> bool:
        posed = zip(self._observations, estimate.rotations, estimate.translations, strict=True)
        return bool(estimate.intrinsics[:2].min() > 0.0) and all(
            ((each.points @ rotation.T + translation)[:, 2] > 0.0).all() for each, rotation, translation in posed
        )

    def _rows(self, estimate: Estimate, view: int) -> tuple[Floats, Floats]:
        """Return the weighted derivatives (2 n, p + 6) of the projections in a view, and the residuals (2 n,)."""
        residual, jacobian = self._linearised(estimate, view)
        weights = np.sqrt(self._weights[view])
        rows = (weights[:, np.newaxis, np.newaxis] * jacobian).reshape(2 * len(weights), -1)
        return rows, (weights[:, np.newaxis] * residual).ravel()

    def _linearised(self, estimate: Estimate, view: int) -> tuple[Floats, Floats]:
        """Return the residuals (n, 2) of a view and the derivatives (n, 2, p + 6) of its projections."""
        seen = self._observations[view]
        rotation, translation = estimate.rotations[view], estimate.translations[view]
        pixels, by_values, by_pose = self._lens.linearised(estimate.intrinsics, rotation, translation, seen.points)
        return seen.pixels - pixels, np.concatenate([by_values, by_pose], axis=2)
