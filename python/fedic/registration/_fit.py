"""The pose that brings points and edges to where they are seen, by weighted least squares.

Point pairs alone are a problem of Levenberg and Marquardt. Edges are measured again after each step, first far and
wide, then closely, with Tukey's weights on the distances. The noise of each feature and of the points comes from what
is left.
"""

from dataclasses import replace

import numpy as np

from fedic._internal.types import Floats
from fedic.errors import CameraError, SolveError
from fedic.registration._covariance import check_known, covariance_of
from fedic.registration._edges import measure_edge
from fedic.registration._pose import similarity_parameters
from fedic.registration._problem import Estimate, Group, Problem, for_all_unknowns, pair_groups

__all__ = ["fit_edges", "fit_pairs"]

_STAGES = ((24.0, 16.0, 6, 0.2), (12.0, 16.0, 8, 0.05), (3.0, 8.0, 40, 1e-3))
"""Reach and band in pixels, most iterations, and the motion in pixels below which the stage is over."""
_FULL_STEPS = 10
_CAUCHY, _TUKEY = 2.4, 4.7
_SMALLEST_NOISE = 0.01
_REWEIGHTINGS = 8
_MEDIAN_OF_NORMAL = 0.6745
_PAIR_ITERATIONS = 200
_EXACT = 1e-9


def fit_pairs(estimate: Estimate, problem: Problem) -> Estimate:
    """Minimise the distances of the points.

    Raises
    ------
    SolveError
        If no minimum is found from this start.
    """
    damping = 1e-3
    residuals, jacobian = _all_pair_rows(estimate, problem)
    for _ in range(_PAIR_ITERATIONS):
        scale = np.maximum(np.linalg.norm(jacobian, axis=0), np.finfo(float).tiny)
        rows = jacobian / scale
        newton = np.linalg.lstsq(rows, residuals, rcond=1e-12)[0]
        if float(np.linalg.norm(rows @ newton)) <= _EXACT:
            return estimate
        damped = np.concatenate([rows, np.sqrt(damping) * np.eye(len(scale))])
        step = np.linalg.lstsq(damped, np.append(residuals, np.zeros(len(scale))), rcond=None)[0] / scale
        try:
            trial = estimate.moved(problem.names, step)
            left, slopes = _all_pair_rows(trial, problem)
        except CameraError:  # a scale that is not positive
            left, slopes = np.full_like(residuals, np.nan), jacobian
        if np.isfinite(left).all() and float(left @ left) < float(residuals @ residuals):
            estimate, residuals, jacobian, damping = trial, left, slopes, max(damping / 10.0, 1e-15)
        elif damping > 1e12:
            return estimate
        else:
            damping *= 10.0
    raise SolveError("The points do not lead to a pose from this start; give a better start, or check the pairs.")


def fit_edges(estimate: Estimate, problem: Problem) -> tuple[Estimate, list[Group], float]:
    """Bring the features to their edges.

    Returns
    -------
    Estimate
        Where they are.
    list of Group
        The rows there, the points' last.
    float
        The largest motion of the last step, in pixels.

    Raises
    ------
    SolveError
        If a parameter would be left so uncertain that the fit may run away.
    """
    motion = np.inf
    for index, (reach, band, iterations, enough) in enumerate(_STAGES):
        cutoff = None if index < len(_STAGES) - 1 else _TUKEY
        names = similarity_parameters(problem.names) if index == 0 else problem.names
        stage = replace(problem, names=names or problem.names)
        if index == 1:
            _check_known(estimate, stage, reach, band)
        for iteration in range(iterations):
            groups = _measured(estimate, stage, reach, band)
            step, groups = _robust_step(groups, cutoff)
            # Pieces that count and do not count in turn would keep the fit swinging between two places.
            estimate = estimate.moved(stage.names, step * 0.5 ** (iteration // _FULL_STEPS))
            motion = max(float(np.abs(group.jacobian @ step).max()) for group in groups)
            if motion <= enough:
                break
    groups = _measured(estimate, problem, *_STAGES[-1][:2])
    return estimate, _robust_step(groups, _TUKEY)[1], motion


def _check_known(estimate: Estimate, problem: Problem, reach: float, band: float) -> None:
    _, groups = _robust_step(_measured(estimate, problem, reach, band), None)
    deviations = np.sqrt(np.diag(covariance_of(groups)[0]))[: len(problem.names)]
    check_known(problem.names, list(deviations), estimate.camera)


def _measured(estimate: Estimate, problem: Problem, reach: float, band: float) -> list[Group]:
    groups = []
    for strip in problem.strips:
        edge = measure_edge(problem.image, estimate.camera, strip, problem.names, reach, band)
        groups.append(Group(edge.distances, for_all_unknowns(estimate, edge.jacobian), edge.valid, 1.0, edge))
    return [*groups, *pair_groups(estimate, problem)]


def _all_pair_rows(estimate: Estimate, problem: Problem) -> tuple[Floats, Floats]:
    """Return residuals and derivatives in standard deviations of the pixels."""
    groups = pair_groups(estimate, problem)
    residuals = np.concatenate([group.residuals / group.noise for group in groups])
    return residuals, np.concatenate([group.jacobian / group.noise for group in groups])


def _robust_step(groups: list[Group], tukey: float | None) -> tuple[Floats, list[Group]]:
    """Solve the linear problem with weights that follow from what it leaves; Cauchy's unless Tukey's are wanted."""
    weights = [group.used.astype(np.float64) for group in groups]
    noises = [group.noise for group in groups]
    step = np.zeros(groups[0].jacobian.shape[1])
    for _ in range(_REWEIGHTINGS):
        roots = [np.sqrt(weight) / noise for weight, noise in zip(weights, noises, strict=True)]
        rows = np.concatenate([root[:, None] * group.jacobian for root, group in zip(roots, groups, strict=True)])
        values = np.concatenate([root * group.residuals for root, group in zip(roots, groups, strict=True)])
        scale = np.maximum(np.linalg.norm(rows, axis=0), np.finfo(float).tiny)
        step = np.linalg.lstsq(rows / scale, values, rcond=1e-9)[0] / scale
        for index, group in enumerate(groups):
            left = group.residuals - group.jacobian @ step
            if not group.known:
                noises[index] = max(_spread(left[group.used]), _SMALLEST_NOISE)
            ratio = left / noises[index]
            if group.edge is None:
                continue
            if tukey is None:
                weights[index] = group.used / (1.0 + (ratio / _CAUCHY) ** 2)
            else:
                weights[index] = group.used * np.maximum(1.0 - (ratio / tukey) ** 2, 0.0) ** 2
    return step, [
        replace(group, used=weight > 0.0, noise=noise)
        for group, weight, noise in zip(groups, weights, noises, strict=True)
    ]


def _spread(left: Floats) -> float:
    return float(np.median(np.abs(left))) / _MEDIAN_OF_NORMAL if len(left) else np.inf
