"""What is doubtful about a measured noise, in sentences."""

import numpy as np

from fedic.noise._pair import LARGEST_MOTION, PairNoise

__all__ = ["doubts_of"]

_CORRELATED = 0.1
_SIGNIFICANCE = 6.0
_FINEST = 0.4
"""Noise in grey steps below which rounding is not independent from image to image."""
_LEAST_SHARE = 0.5


def doubts_of(
    pairs: list[PairNoise],
    std: float,
    correlation: tuple[float, float],
    step: float,
    used_share: float,
    num_pixels: int,
    changed: tuple[int, int],
) -> tuple[str, ...]:
    """Return what is doubtful.

    Parameters
    ----------
    pairs : list of PairNoise
        The pairs of consecutive images.
    std : float
        Standard deviation of the noise, in grey levels.
    correlation : (float, float)
        Correlation of neighbouring pixels along u and v.
    step : float
        Distance of grey levels; 0 if it is not known.
    used_share : float
        Share of the pixels used.
    num_pixels : int
        Number of pixels used.
    changed : (int, int)
        Number of tiles that read far more than the others, and of all.

    Returns
    -------
    tuple of str
        One sentence each, without a full stop.
    """
    found = _motion(pairs, std)
    limit = max(_CORRELATED, _SIGNIFICANCE / np.sqrt(max(1, num_pixels)))
    if max(map(abs, correlation)) > limit:
        found.append(
            f"the noise of neighbouring pixels is correlated ({correlation[0]:.2f} along u, {correlation[1]:.2f} along "
            "v), by compression, colour reduced to grey, or filtering: predicted standard deviations, which take it as "
            "white, are too small"
        )
    if std < _FINEST * step:
        found.append(
            f"the noise is below {_FINEST:g} steps of the grey levels: it is hidden by their rounding; record more bits"
        )
    if changed[0]:
        found.append(
            f"{changed[0]} of {changed[1]} tiles read over twice the variance of the others at their grey level: "
            "something changed there, which counts as noise"
        )
    if used_share < _LEAST_SHARE:
        found.append(f"only {used_share:.0%} of the pixels lie between black and full scale: change the exposure")
    return tuple(found)


def _motion(pairs: list[PairNoise], std: float) -> list[str]:
    moved = [pair for pair in pairs if pair.moved]
    found = []
    kept = [pair for pair in moved if not pair.refused]
    of = "the images" if len(pairs) == 1 else f"{{}} of {len(pairs)} pairs of images"
    if kept:
        worst = max(kept, key=lambda pair: pair.excess)
        most = "" if len(kept) == 1 else "up to "
        found.append(
            f"{of.format(len(kept))} moved by {most}{worst.motion:.2g} px: the noise reads {most}{worst.excess:.0%} "
            f"too high, which is corrected ({std:.4g} grey levels without the motion)"
        )
    refused = [pair for pair in moved if pair.refused]
    if refused:
        motions = [pair.motion for pair in refused if np.isfinite(pair.motion)]
        by = f"by {'up to ' if len(motions) > 1 else ''}{max(motions):.2g} px" if motions else "or changed"
        fate = "they tell no noise" if len(refused) == len(pairs) else "they are left out"
        found.append(
            f"{of.format(len(refused))} moved {by}, and differ by more than light, noise and a motion of "
            f"{LARGEST_MOTION:g} px: {fate}; fix the camera and the specimen, and take the images again"
        )
    return found
