"""Weighted least-squares fit of a pose to point pairs and edges.

Point pairs alone are a nonlinear least-squares problem. Edges are measured again after each step, first over wide and
then over narrow bands, with Tukey's weights on the distances. The noise of each feature and of the points is estimated
from the residuals.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fedic._internal.least_squares import DenseEquations, minimize
from fedic._internal.robust_weights import cauchy_weights, deviation_of_residuals, tukey_weights
from fedic._internal.types import Floats
from fedic.errors import SolveError
from fedic.registration._covariance import check_known, covariance_of
from fedic.registration._edges import measure_edge
from fedic.registration._pose import similarity_parameters
from fedic.registration._problem import Estimate, Group, Problem, for_all_unknowns, pair_groups

__all__ = ["fit_edges", "fit_pairs"]

_STAGES = ((24.0, 16.0, 6, 0.2), (12.0, 16.0, 8, 0.05), (3.0, 8.0, 40, 1e-3))
"""Search distance and band in pixels, largest number of iterations, and motion in pixels that ends the stage."""
_FULL_STEPS = 10
_SMALLEST_NOISE = 0.01
_REWEIGHTINGS = 8
_PAIR_ITERATIONS = 200
_TOLERANCE, _IMMATERIAL = 1e-9, 1e-6


def fit_pairs(estimate: Estimate, problem: Problem) -> Estimate:
    """Minimise the distances of the point pairs.

    Raises
    ------
    SolveError
        If no minimum is found from this start.
    """
    minimum = minimize(
        _PairProblem(problem),
        estimate,
        tolerance=_TOLERANCE,
        immaterial=_IMMATERIAL,
        noise=1.0,
        max_iterations=_PAIR_ITERATIONS,
    )
    if not minimum.converged:
        raise SolveError("The points do not lead to a pose from this start; give a better start, or check the pairs.")
    return minimum.estimate


@dataclass(frozen=True, eq=False)
class _PairProblem:
    """Point pairs as a `fedic._internal.least_squares.Problem`, in standard deviations of the pixels."""

    problem: Problem

    def linearize(self, estimate: Estimate) -> DenseEquations:
        groups = pair_groups(estimate, self.problem)
        jacobian = np.concatenate([group.jacobian / group.noise for group in groups])
        return DenseEquations(jacobian, self.residuals(estimate))

    def residuals(self, estimate: Estimate) -> Floats:
        groups = pair_groups(estimate, self.problem)
        return np.concatenate([group.residuals / group.noise for group in groups])

    def cost(self, estimate: Estimate) -> float:
        residuals = self.residuals(estimate)
        total = float(residuals @ residuals)
        return total if np.isfinite(total) else np.inf

    def move(self, estimate: Estimate, step: Floats) -> Estimate:
        return estimate.moved(self.problem.names, step)


def fit_edges(estimate: Estimate, problem: Problem) -> tuple[Estimate, list[Group], float]:
    """Fit the features to their edges in the image.

    Returns
    -------
    Estimate
        The minimum.
    list of Group
        The rows at the minimum, those of the points last.
    float
        The largest motion of the last step, in pixels.

    Raises
    ------
    SolveError
        If the data hardly determine a parameter, so that the fit may diverge.
    """
    motion = np.inf
    for index, (reach, band, iterations, enough) in enumerate(_STAGES):
        edge_weights = cauchy_weights if index < len(_STAGES) - 1 else tukey_weights
        names = similarity_parameters(problem.names) if index == 0 else problem.names
        stage = replace(problem, names=names or problem.names)
        if index == 1:
            _check_known(estimate, stage, reach, band)
        for iteration in range(iterations):
            groups = _measured(estimate, stage, reach, band)
            step, groups = _robust_step(groups, edge_weights)
            # Segments that are used and left out in turn would make the fit oscillate.
            estimate = estimate.moved(stage.names, step * 0.5 ** (iteration // _FULL_STEPS))
            motion = max(float(np.abs(group.jacobian @ step).max()) for group in groups)
            if motion <= enough:
                break
    groups = _measured(estimate, problem, *_STAGES[-1][:2])
    return estimate, _robust_step(groups, tukey_weights)[1], motion


def _check_known(estimate: Estimate, problem: Problem, reach: float, band: float) -> None:
    _, groups = _robust_step(_measured(estimate, problem, reach, band), cauchy_weights)
    deviations = np.sqrt(np.diag(covariance_of(groups)[0]))[: len(problem.names)]
    check_known(problem.names, list(deviations), estimate.camera)


def _measured(estimate: Estimate, problem: Problem, reach: float, band: float) -> list[Group]:
    groups = []
    for strip in problem.strips:
        edge = measure_edge(problem.image, estimate.camera, strip, problem.names, reach, band)
        groups.append(Group(edge.distances, for_all_unknowns(estimate, edge.jacobian), edge.valid, 1.0, edge))
    return [*groups, *pair_groups(estimate, problem)]


def _robust_step(groups: list[Group], edge_weights: Callable[[Floats], Floats]) -> tuple[Floats, list[Group]]:
    """Solve the linear problem, reweighted by its own residuals; also return the groups with their new noise.

    Parameters
    ----------
    groups : list of Group
        The rows.
    edge_weights : callable
        Weights of the edge pieces from their residuals in standard deviations.
    """
    weights = [group.used.astype(np.float64) for group in groups]
    noises = [group.noise for group in groups]
    step = np.zeros(groups[0].jacobian.shape[1])
    for _ in range(_REWEIGHTINGS):
        roots = [np.sqrt(weight) / noise for weight, noise in zip(weights, noises, strict=True)]
        rows = np.concatenate([root[:, None] * group.jacobian for root, group in zip(roots, groups, strict=True)])
        values = np.concatenate([root * group.residuals for root, group in zip(roots, groups, strict=True)])
        step, _ = DenseEquations(rows, values).solve(0.0)
        for index, group in enumerate(groups):
            left = group.residuals - group.jacobian @ step
            if not group.known:
                noises[index] = max(deviation_of_residuals(left[group.used]), _SMALLEST_NOISE)
            if group.edge is not None:
                weights[index] = group.used * edge_weights(left / noises[index])
    return step, [
        replace(group, used=weight > 0.0, noise=noise)
        for group, weight, noise in zip(groups, weights, noises, strict=True)
    ]
