"""Choice of the smoothing of a non-parametric lens by cross-validation over the views."""

from dataclasses import replace

import numpy as np

from fedic.calibration._adjustment.bundle import Bundle, Estimate
from fedic.calibration.lenses import SplineLens

__all__ = ["select_smoothing"]

_FOLDS = 5
_TRIED = np.logspace(-13.0, 2.0, 16)


def select_smoothing(lens: SplineLens, bundle: Bundle, estimate: Estimate) -> SplineLens:
    """Choose the smoothing of a lens that minimises the cross-validation error.

    The views are divided into five groups. The field is fitted to all groups but one, and the error is that of the
    points of this one, its poses being free. Leaving out whole views, not single points, keeps errors that the points
    of a view share (of the target or the lighting) from being attributed to the lens. The problem is linear in the
    field and nearly linear in the poses, so that one linearisation is enough.

    Parameters
    ----------
    lens : SplineLens
        The lens; its smoothing is ignored.
    bundle : Bundle
        At least two views, with any smoothing.
    estimate : Estimate
        An estimate near the minimum.

    Returns
    -------
    SplineLens
        The lens with its smoothing.
    """
    views = len(estimate.rotations)
    count = min(_FOLDS, views)
    matrices = np.zeros((count, lens.size, lens.size))
    sides, costs = np.zeros((count, lens.size)), np.zeros(count)
    for view in range(views):
        matrix, side, cost = bundle.eliminated(estimate, view)
        matrices[view % count] += matrix
        sides[view % count] += side
        costs[view % count] += cost
    matrix, side = matrices.sum(axis=0), sides.sum(axis=0)
    start = estimate.intrinsics
    errors = np.zeros(len(_TRIED))
    for index, smoothing in enumerate(_TRIED):
        form = lens.penalty_of(smoothing)
        for own_matrix, own_side, own_cost in zip(matrices, sides, costs, strict=True):
            step = np.linalg.solve(matrix - own_matrix + form, side - own_side - form @ start)
            errors[index] += own_cost + step @ (own_matrix @ step - 2.0 * own_side)
    return replace(lens, smoothing=float(_TRIED[int(np.argmin(errors))]))
