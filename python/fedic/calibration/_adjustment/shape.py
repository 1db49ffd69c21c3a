"""Release of the shape of the target, where the views show that it is not as planned."""

from dataclasses import replace

import numpy as np

from fedic._internal.types import Floats
from fedic.calibration._adjustment.bundle import Bundle, Estimate
from fedic.calibration._adjustment.correlation import correlation_factor
from fedic.calibration._adjustment.fit import Fit, fit
from fedic.calibration.lenses import SHAPES, CoefficientLens, Lens, ShapedTarget
from fedic.calibration.observation import Observation
from fedic.errors import CameraError

__all__ = ["fit_shape", "shape_of"]

_SIGNIFICANT = 5.0
_PROMISING = 3.0
_TRIAL_ITERATIONS = 30
_STRAIGHT, _BENT = SHAPES[:2], SHAPES[2:]


def fit_shape(found: Fit, observations: list[Observation], image_size: tuple[int, int]) -> Fit:
    """Fit again with those unknowns of the shape of the target that differ from zero by five standard deviations.

    The stretch and the skew are tried first, then the bend: by one step of the linearised problem, and if some unknown
    promises three standard deviations, by iteration. The variance is enlarged by the correlation of the residuals that
    remain (`correlation_factor`).

    Parameters
    ----------
    found : Fit
        Fit with the target as planned.
    observations : list of Observation
        One per view, with the points of the plan.
    image_size : (int, int)
        Width and height in pixels.

    Returns
    -------
    Fit
        With a `ShapedTarget` for lens if the target is not as planned; else `found`. A non-parametric lens takes the
        target as planned: it hardly differs from a stretch.
    """
    if not isinstance(found.lens, CoefficientLens):
        return found
    own = found.lens
    for tried in (_STRAIGHT, _BENT):
        shapes = _significant(found, own, observations, tried)
        if not shapes:
            continue
        free = tuple(name for name in SHAPES if name in (*_shapes(found.lens), *shapes))
        lens = _shaped(own, free, observations)
        try:
            freed = fit(lens, observations, image_size, _extended(found, lens))
        except (CameraError, np.linalg.LinAlgError):
            continue
        found = replace(freed, initial_errors=found.initial_errors)
    return found


def shape_of(found: Fit) -> dict[str, tuple[float, float]]:
    """Return value and standard deviation of each free unknown of the shape."""
    size = found.lens.size
    values = found.estimate.intrinsics
    deviations = np.sqrt(np.diag(found.covariance)[:size])
    shapes = _shapes(found.lens)
    places = range(size - len(shapes), size)
    return {name: (float(values[place]), float(deviations[place])) for name, place in zip(shapes, places, strict=True)}


def _significant(
    found: Fit, own: CoefficientLens, observations: list[Observation], tried: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the unknowns that differ from zero if they are freed."""
    lens = _shaped(own, (*_shapes(found.lens), *tried), observations)
    kept = [observations[view] for view in found.accepted]
    used = [found.used[view] for view in found.accepted]
    bundle = Bundle(lens, kept, [mask.astype(np.float64) for mask in used])
    start = _extended(found, lens).of(found.accepted)
    places = np.arange(lens.size - len(tried), lens.size)
    try:
        matrix, gradient, cost = bundle.linearize(start).eliminated()
        step, variances = np.linalg.solve(matrix, gradient), np.diag(np.linalg.inv(matrix))
        variance = (cost - float(gradient @ step)) / max(bundle.freedom, 1)
        if not (step[places] ** 2 > _PROMISING**2 * variance * variances[places]).any():
            return ()
        near = bundle.minimize(start, _TRIAL_ITERATIONS).estimate
        covariance = bundle.covariance(near)
    except (CameraError, np.linalg.LinAlgError):
        return ()
    residuals = bundle.distances(near)
    factor = correlation_factor(
        [each.points[mask] for each, mask in zip(kept, used, strict=True)],
        [each[mask] for each, mask in zip(residuals, used, strict=True)],
    )
    deviations = np.sqrt(factor * np.diag(covariance)[places])
    moves = np.abs(near.intrinsics[places])
    return tuple(
        name for name, move, deviation in zip(tried, moves, deviations, strict=True) if move > _SIGNIFICANT * deviation
    )


def _shapes(lens: Lens) -> tuple[str, ...]:
    return lens.shapes if isinstance(lens, ShapedTarget) else ()


def _shaped(lens: CoefficientLens, shapes: tuple[str, ...], observations: list[Observation]) -> ShapedTarget:
    points: Floats = np.concatenate([each.points[:, :2] for each in observations])
    low, high = points.min(axis=0), points.max(axis=0)
    return ShapedTarget(lens, shapes, 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low)))


def _extended(found: Fit, lens: ShapedTarget) -> Estimate:
    """Return the estimate of a fit with the further unknowns of a lens at zero."""
    own = dict(zip(_shapes(found.lens), found.estimate.intrinsics[lens.lens.size :], strict=True))
    values = [*found.estimate.intrinsics[: lens.lens.size], *(own.get(name, 0.0) for name in lens.shapes)]
    return replace(found.estimate, intrinsics=np.array(values))
