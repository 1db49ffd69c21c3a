"""Nonlinear least squares: Levenberg-Marquardt with geodesic acceleration (Transtrum and Sethna, 2012).

`scipy.optimize.least_squares` lacks three things that are needed: unknowns that are not vectors (rotations), the block
structure of a bundle adjustment, whose poses are eliminated view by view, and the acceleration, without which the
narrow curved valleys of poorly determined parameters take hundreds of iterations.
"""

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from fedic._internal.types import Floats
from fedic.errors import CameraError

__all__ = ["DenseEquations", "Equations", "Minimum", "Problem", "minimize", "scaled_inverse"]

Estimate = TypeVar("Estimate")

_PROBE = 0.1
"""Fraction of a step over which the curvature along it is measured."""
_LARGEST_DAMPING = 1e12
_SMALLEST_DAMPING = 1e-12
_SMALLEST_RATIO = 1e-9
"""Singular values, relative to the largest, below which directions are left out of a dense solution."""
_ROUNDING = 1e-13
"""Decrease of the cost, relative to the cost, below which rounding may hide it."""
_TINY = float(np.finfo(np.float64).tiny)


class Equations(Protocol):
    """The linearised problem at an estimate."""

    @property
    def cost(self) -> float:
        """Sum of the squared residuals, and of penalties."""

    @property
    def residuals(self) -> Floats:
        """Weighted residuals, shape (m,)."""

    def solve(self, damping: float, target: Floats | None = None) -> tuple[Floats, float]:
        """Solve for the step that changes the model by a target.

        Parameters
        ----------
        damping : float
            Levenberg-Marquardt damping, relative to the diagonal of the normal matrix.
        target : ndarray, shape (m,), optional
            Wanted change of the weighted model; by default the residuals and the gradient of the penalties.

        Returns
        -------
        ndarray, shape (p,)
            The step.
        float
            Squared length of the step in the undamped normal matrix.
        """

    def apply(self, step: Floats) -> Floats:
        """Return the change (m,) of the weighted model along a step, to first order."""


class Problem(Protocol[Estimate]):
    """A least-squares problem.

    Its methods may raise `CameraError` at an estimate that is no camera; the step to it is then rejected.
    """

    def linearize(self, estimate: Estimate) -> Equations:
        """Linearise the problem."""

    def residuals(self, estimate: Estimate) -> Floats:
        """Return the weighted residuals (m,), measured minus model; not finite where the model is undefined."""

    def cost(self, estimate: Estimate) -> float:
        """Return the sum of the squared residuals, and of penalties; infinite where the model is undefined."""

    def move(self, estimate: Estimate, step: Floats) -> Estimate:
        """Return the estimate moved by a step."""


@dataclass(frozen=True)
class Minimum(Generic[Estimate]):
    """Outcome of a minimisation.

    Attributes
    ----------
    estimate : Estimate
        The best estimate.
    converged : bool
        False if the steps did not become small within the iterations, or no step lowers the cost.
    """

    estimate: Estimate
    converged: bool


def minimize(
    problem: Problem[Estimate],
    estimate: Estimate,
    *,
    tolerance: float,
    immaterial: float,
    noise: float | None = None,
    freedom: int = 1,
    smallest_noise: float = 0.0,
    damping: float = 1e-3,
    max_iterations: int,
) -> Minimum[Estimate]:
    """Minimise a least-squares problem.

    The length of a step is that of the change of the weighted model, in standard deviations of a residual.

    Parameters
    ----------
    problem : Problem
        The problem.
    estimate : Estimate
        The start.
    tolerance : float
        Length of the Gauss-Newton step below which the minimum is reached.
    immaterial : float
        Length of the Gauss-Newton step below which the minimum is reached where a step does not lower the cost: the
        rest is rounding. So is a step that should lower the cost by less than 1e-13 of it.
    noise : float, optional
        Standard deviation of a residual; by default estimated from the cost.
    freedom : int
        Residuals less unknowns, for that estimate.
    smallest_noise : float
        Lower bound of that estimate.
    damping : float
        Damping of the first step.
    max_iterations : int
        Largest number of steps tried.

    Returns
    -------
    Minimum
        The best estimate.
    """
    equations = problem.linearize(estimate)
    for _ in range(max_iterations):
        try:
            newton, squared = equations.solve(0.0)
            step = _accelerated(problem, estimate, equations, damping)
        except np.linalg.LinAlgError:
            return Minimum(estimate, converged=False)
        deviation = noise or max(np.sqrt(equations.cost / max(freedom, 1)), smallest_noise)
        length = np.sqrt(max(squared, 0.0)) / deviation
        if length <= tolerance:
            return Minimum(problem.move(estimate, newton), converged=True)
        trial = _moved(problem, estimate, step)
        if trial is not None and problem.cost(trial) < equations.cost:
            estimate, damping = trial, max(damping / 10.0, _SMALLEST_DAMPING)
            equations = problem.linearize(estimate)
        elif length <= immaterial or squared <= _ROUNDING * equations.cost:
            return Minimum(estimate, converged=True)
        else:
            damping *= 10.0
            if damping > _LARGEST_DAMPING:
                break
    return Minimum(estimate, converged=False)


def _moved(problem: Problem[Estimate], estimate: Estimate, step: Floats) -> Estimate | None:
    try:
        return problem.move(estimate, step)
    except CameraError:
        return None


def _accelerated(problem: Problem[Estimate], estimate: Estimate, equations: Equations, damping: float) -> Floats:
    """Return the damped step with half the second-order correction along it, unless that is the longer of the two."""
    step, _ = equations.solve(damping)
    probe = _moved(problem, estimate, _PROBE * step)
    if probe is None:
        return step
    ahead = problem.residuals(probe)
    curvature = 2.0 / _PROBE * ((ahead - equations.residuals) / _PROBE + equations.apply(step))
    if not np.isfinite(curvature).all():
        return step
    correction, _ = equations.solve(damping, curvature)
    return step + 0.5 * correction if np.linalg.norm(correction) <= np.linalg.norm(step) else step


class DenseEquations:
    """Linearised problem with a dense Jacobian.

    Columns are scaled to unit length, since the unknowns differ in unit.

    Parameters
    ----------
    jacobian : ndarray, shape (m, p)
        Weighted derivatives of the model.
    residuals : ndarray, shape (m,)
        Weighted residuals.
    """

    def __init__(self, jacobian: Floats, residuals: Floats) -> None:
        self._jacobian = jacobian
        self._scale = np.maximum(np.linalg.norm(jacobian, axis=0), _TINY)
        self.residuals = residuals
        self.cost = float(residuals @ residuals)

    def solve(self, damping: float, target: Floats | None = None) -> tuple[Floats, float]:
        """Solve for a step, see `Equations.solve`."""
        rows = scaled = self._jacobian / self._scale
        values = self.residuals if target is None else target
        if damping > 0.0:
            count = len(self._scale)
            rows = np.concatenate([scaled, np.sqrt(damping) * np.eye(count)])
            values = np.append(values, np.zeros(count))
        step = np.linalg.lstsq(rows, values, rcond=_SMALLEST_RATIO)[0]
        change = scaled @ step
        return step / self._scale, float(change @ change)

    def apply(self, step: Floats) -> Floats:
        """Return the change of the weighted model along a step, see `Equations.apply`."""
        change: Floats = self._jacobian @ step
        return change


def scaled_inverse(normal: Floats) -> Floats:
    """Invert a normal matrix whose unknowns differ in unit.

    Parameters
    ----------
    normal : ndarray, shape (p, p)
        Symmetric positive definite matrix.

    Returns
    -------
    ndarray, shape (p, p)
        Its inverse.
    """
    scale = np.sqrt(np.diag(normal))
    inverse: Floats = np.linalg.inv(normal / np.outer(scale, scale)) / np.outer(scale, scale)
    return inverse
