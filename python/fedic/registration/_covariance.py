"""What the data leave open, and how well they determine the rest."""

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
    """Check that no combination of the unknowns leaves all rows as they are.

    Parameters
    ----------
    groups : sequence of Group
        The rows.
    names : sequence of str
        The unknowns.

    Raises
    ------
    CameraError
        If the camera does not see what the rows are about.
    SolveError
        If one does; the message names its parameters.
    """
    rows = np.concatenate([group.jacobian[group.used] for group in groups])
    if not np.isfinite(rows).all():
        raise CameraError("camera: from its start it does not see all the points and features; correct the start.")
    open_names = undetermined(names, rows)
    if open_names:
        raise SolveError(
            f"The points and features given do not determine {join_names(open_names)}: the image of the mesh can move "
            "in a way they do not show. Add point pairs or features that do, such as a hole or a side across the "
            "others, or hold parameters with free=(...)."
        )


def check_known(names: Sequence[str], deviations: Sequence[float], camera: Placeable) -> None:
    """Check that no parameter of the pose is left so uncertain that it means nothing.

    Raises
    ------
    SolveError
        If an angle is uncertain by over 0.2 rad, or the scale or distance by over a tenth.
    """
    size = camera.scale if isinstance(camera, FrontParallel) else abs(camera.translation[2])
    limits = {"scale": LARGEST_RELATIVE_DEVIATION * size, "tz": LARGEST_RELATIVE_DEVIATION * size}
    limits.update(dict.fromkeys(("angle", "rx", "ry", "rz"), _POOREST_ANGLE))
    pairs = zip(names, deviations, strict=True)
    poor = [(name, value) for name, value in pairs if value > limits.get(name, np.inf)]
    if poor:
        uncertain = ", ".join(f"{name} (standard deviation {value:.2g})" for name, value in poor)
        raise SolveError(
            f"The points and features given hardly determine {uncertain}: hold what is known from elsewhere by leaving "
            "it out of free=(...), or add points and features further apart."
        )


def covariance_of(groups: Sequence[Group]) -> tuple[Floats, list[float]]:
    """Return the covariance of the unknowns, and the noise of each group.

    Least squares with the noise of each group from its own residuals, less the freedom the unknowns take away. The
    errors of neighbouring pieces of an edge are correlated where speckles are as long as the pieces: the variance of a
    feature is enlarged by the sum of the correlations of its residuals, and for the levels that neighbours share.

    Parameters
    ----------
    groups : sequence of Group
        The rows at the minimum.

    Returns
    -------
    ndarray, shape (p, p)
        NaN where there are no more rows than unknowns and the noise is not known.
    list of float
        Standard deviations in pixels.
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
    """Return the sum of the correlations of residuals at all lags, up to the first that is not positive; at least 1."""
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
