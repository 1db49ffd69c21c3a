"""Checks that the data determine the unknowns, and the covariance of the unknowns."""

from collections.abc import Sequence

import numpy as np

from fedic._core import FrontParallel
from fedic._internal.determinacy import LARGEST_RELATIVE_DEVIATION, join_names, undetermined
from fedic._internal.least_squares import scaled_inverse
from fedic._internal.types import Floats
from fedic.errors import CameraError, SolveError
from fedic.registration._pose import Placeable
from fedic.registration._problem import Group

__all__ = ["check_determined", "check_known", "covariance_of"]

_POOREST_ANGLE = 0.2
_LONGEST_LAG = 0.25


def check_determined(groups: Sequence[Group], names: Sequence[str]) -> None:
    """Check that the data determine all unknowns.

    Parameters
    ----------
    groups : sequence of Group
        Rows of the least-squares problem.
    names : sequence of str
        Names of the unknowns.

    Raises
    ------
    CameraError
        If the camera does not see all points and features.
    SolveError
        If some combination of the unknowns changes no row; the message names its parameters.
    """
    rows = np.concatenate([group.jacobian[group.used] for group in groups])
    if not np.isfinite(rows).all():
        raise CameraError("camera: the given pose does not see all points and features; correct it.")
    open_names = undetermined(names, rows)
    if open_names:
        raise SolveError(
            f"The points and features given do not determine {join_names(open_names)}: the image of the mesh can move "
            "in a way they do not show. Add point pairs or features that do, such as a hole or a side across the "
            "others, or hold parameters with free=(...)."
        )


def check_known(names: Sequence[str], deviations: Sequence[float], camera: Placeable) -> None:
    """Check that the standard deviations of the pose are small enough to be of use.

    Raises
    ------
    SolveError
        If the standard deviation of an angle is above 0.2 rad, or that of the scale or distance above 10 %.
    """
    size = camera.scale if isinstance(camera, FrontParallel) else abs(camera.translation[2])
    limits = {"scale": LARGEST_RELATIVE_DEVIATION * size, "tz": LARGEST_RELATIVE_DEVIATION * size}
    limits.update(dict.fromkeys(("angle", "rx", "ry", "rz"), _POOREST_ANGLE))
    pairs = zip(names, deviations, strict=True)
    poor = [(name, value) for name, value in pairs if value > limits.get(name, np.inf)]
    if poor:
        uncertain = ", ".join(f"{name} (standard deviation {value:.2g})" for name, value in poor)
        raise SolveError(
            f"The points and features given hardly determine {uncertain}: leave known parameters out of free=(...), "
            "add points and features further apart, or check that the points are where their image points are."
        )


def covariance_of(groups: Sequence[Group]) -> tuple[Floats, list[float]]:
    """Return the covariance of the unknowns and the noise of each group.

    The noise of a group is estimated from its residuals and its degrees of freedom. The errors of neighbouring segments
    of an edge are correlated where speckles are as long as the segments: the variance of a feature is multiplied by the
    sum of the correlations of its residuals, and by the inflation of `Edge`.

    Parameters
    ----------
    groups : sequence of Group
        The rows at the minimum.

    Returns
    -------
    ndarray, shape (p, p)
        Covariance; NaN if the noise is unknown and there are no more rows than unknowns.
    list of float
        Standard deviation of each group in pixels.
    """
    noises = [group.noise for group in groups]
    inverse = np.linalg.pinv(_normal(groups, noises))
    for index, group in enumerate(groups):
        if group.known:
            continue
        rows, left = group.jacobian[group.used], group.residuals[group.used]
        taken = float(np.einsum("np,pq,nq->", rows, inverse, rows)) / noises[index] ** 2
        freedom = len(left) - taken
        variance = float(left @ left) / freedom if freedom > 1e-6 * len(left) else np.nan
        if group.edge is not None:
            variance *= group.edge.inflation * _correlation_length(np.where(group.used, group.residuals, np.nan))
        noises[index] = float(np.sqrt(variance))
    if not np.isfinite(noises).all():
        return np.full_like(inverse, np.nan), noises
    floors = [max(noise, 1e-12) for noise in noises]
    return scaled_inverse(_normal(groups, floors)), noises


def _normal(groups: Sequence[Group], noises: Sequence[float]) -> Floats:
    parts = [group.jacobian[group.used] / noise for group, noise in zip(groups, noises, strict=True)]
    rows = np.concatenate(parts)
    normal: Floats = rows.T @ rows
    return normal


def _correlation_length(left: Floats) -> float:
    """Return the sum of the autocorrelation of residuals, up to the first lag where it is not positive; at least 1."""
    known = np.isfinite(left)
    centred = np.where(known, left, 0.0)
    variance = float((centred**2).sum()) / max(int(known.sum()), 1)
    total = 1.0
    for lag in range(1, int(_LONGEST_LAG * len(left)) + 1):
        both = known[lag:] & known[:-lag]
        if not both.any() or variance == 0.0:
            break
        correlation = float((centred[lag:] * centred[:-lag]).sum()) / int(both.sum()) / variance
        if correlation <= 0.0:
            break
        total += 2.0 * correlation
    return total
