"""How much to smooth a non-parametric lens: cross-validation over the views."""

from dataclasses import replace

import numpy as np

from fedic.calibration._adjustment.bundle import Bundle, Estimate
from fedic.calibration.lenses import SplineLens

__all__ = ["smoothed"]

_FOLDS = 5
_TRIED = np.logspace(-13.0, 2.0, 16)


def smoothed(lens: SplineLens, bundle: Bundle, estimate: Estimate) -> SplineLens:
    """Choose the smoothing of a lens.

    The views are dealt out in five groups. The field is fitted to all groups but one, and the points of that one, its
    poses free, are held against it; the smoothing that foretells them best is taken. Errors that the points of a view
    share, of the target or the light, are not taken for the lens then, as they would be if points were left out one by
    one. The problem is linear in the field and nearly so in the poses: one linearisation serves all.

    Parameters
    ----------
    lens : SplineLens
        The lens; its smoothing is not looked at.
    bundle : Bundle
        The views, at least two, with any smoothing.
    estimate : Estimate
        Near the minimum.

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
