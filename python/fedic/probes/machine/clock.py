"""The offset between two clocks, from a signal that both record."""

import math
import warnings
from typing import NamedTuple

import numpy as np

from fedic._internal.types import Floats
from fedic._internal.warning_level import levels_within_fedic
from fedic.errors import OptionError, QualityWarning

__all__ = ["ClockOffset", "find_offset"]

_FEWEST = 6
"""Smallest number of frames within the record of the machine."""
_SMALLEST_SHARE = 0.3
"""Smallest share of the frames within the record of the machine."""
_MOST_OFFSETS = 20_000
_MOST_FRAMES = 400
_CHUNK = 500
"""Offsets of the search, frames in it, and offsets evaluated at once."""
_STEPS_PER_FRAME = 4
_HUBER = 1.345
"""Residual in standard deviations beyond which its influence stays the same: 95 % efficiency for normal noise."""
_ITERATIONS = 50
_L1_ITERATIONS = 8
_LEAST_SCALE = 0.005
"""Smallest scale of the residual, relative to the mean absolute deviation of the signal."""
_WORST_CONDITION = 1e6
_LEAST_EXPLAINED = 0.5
_RIVAL = 0.05
"""Offsets are rivals if the shares that they do not explain differ by less."""


class ClockOffset(NamedTuple):
    """Seconds that are added to the clock of the machine to give that of the frames.

    Attributes
    ----------
    offset, standard_deviation : float
        In seconds. The standard deviation is that to first order in the scatter of the frames about the fit.
    explained : float
        Share of the variance of the measured signal that the machine's explains, at most 1, with Huber's weights.
    """

    offset: float
    standard_deviation: float
    explained: float


def find_offset(times: Floats, channel: Floats, frame_times: Floats, signal: Floats, start: str = "") -> ClockOffset:
    """Find the offset at which a channel of the machine explains a measured signal.

    The signal of frame ``k`` at ``t_k`` is taken as ``a F(t_k - d) + b`` with the channel ``F``. A search over all
    offsets ``d`` minimises the sum of the absolute residuals, where frames outside the record count as not explained.
    Iterations with Huber's weights then refine ``a``, ``b`` and ``d`` on the frames inside the record. Single wrong
    frames have little influence on either.

    Parameters
    ----------
    times, channel : ndarray, shape (n,)
        Clock of the machine in seconds, increasing, and its channel.
    frame_times, signal : ndarray, shape (m,)
        Times of the frames in seconds, and the measured signal; frames with a NaN are left out.
    start : str, optional
        What messages begin with, such as the name of the channel.

    Returns
    -------
    ClockOffset
        The offset.

    Raises
    ------
    OptionError
        If there are fewer than 6 frames, or the signals do not determine the offset.

    Warns
    -----
    QualityWarning
        If another offset explains the signal almost as well.
    """
    known, recorded = np.isfinite(frame_times) & np.isfinite(signal), np.isfinite(channel)
    moments, values = frame_times[known], signal[known]
    clock, force = times[recorded], channel[recorded]
    if len(moments) < _FEWEST or len(clock) < 2 or not np.ptp(values) > 0 or not np.ptp(force) > 0:
        raise OptionError(
            f"{start}the offset cannot be found: that takes {_FEWEST} frames with a time and a signal, and signals "
            "that change.",
            "correlate",
        )
    order = np.argsort(moments)
    moments, values = moments[order], values[order]
    every = float(np.median(np.diff(moments)))
    offsets, missing = _search(clock, force, moments, values, every)
    best = int(np.argmin(missing))
    found = _refined(clock, force, moments, values, float(offsets[best]), every)
    if not (found.explained > _LEAST_EXPLAINED and found.standard_deviation < 2.0 * every):
        raise OptionError(
            f"{start}the signals do not determine the offset: the machine explains {max(found.explained, 0.0):.0%} of "
            f"the measured signal, and the offset would be known to {found.standard_deviation:.2g} s; choose signals "
            "that are proportional and have a start, a hold or a reversal, or give offset as a number.",
            "correlate",
        )
    _warn_of_rivals(start, offsets, missing, best, found)
    return found


def _search(clock: Floats, force: Floats, moments: Floats, values: Floats, every: float) -> tuple[Floats, Floats]:
    """Return offsets, and the share of the absolute deviation of the signal that each does not explain."""
    low, high = moments[0] - clock[-1], moments[-1] - clock[0]
    count = int(min(math.ceil((high - low) / every * _STEPS_PER_FRAME) + 1, _MOST_OFFSETS))
    offsets = np.linspace(low, high, count)
    taken = np.unique(np.linspace(0, len(moments) - 1, min(len(moments), _MOST_FRAMES)).astype(int))
    chunks = (offsets[first : first + _CHUNK] for first in range(0, count, _CHUNK))
    return offsets, np.concatenate([_missing(clock, force, moments[taken], values[taken], chunk) for chunk in chunks])


def _missing(clock: Floats, force: Floats, moments: Floats, values: Floats, offsets: Floats) -> Floats:
    """Return the share of the absolute deviation of the signal that offsets do not explain, (offsets,)."""
    at = moments - offsets[:, np.newaxis]
    inside = (at >= clock[0]) & (at <= clock[-1])
    machine = np.interp(at, clock, force)
    machine = (machine - np.median(force)) / np.ptp(force)
    deviation = values - np.median(values)
    total = np.abs(deviation).sum()
    weights = inside.astype(np.float64)
    left = np.broadcast_to(deviation, at.shape)
    for _ in range(_L1_ITERATIONS):
        sums = [(weights * each).sum(axis=1) for each in (1.0, machine, machine**2, deviation, machine * deviation)]
        count, first, second, mean, cross = sums
        divisor = count * second - first**2
        ridge = 1e-9 * np.maximum(count * second, 1e-300)
        factor = (count * cross - first * mean) / np.maximum(divisor, ridge)
        constant = (mean - factor * first) / np.maximum(count, 1e-300)
        left = deviation - factor[:, np.newaxis] * machine - constant[:, np.newaxis]
        weights = inside / np.maximum(np.abs(left), 1e-4 * total / len(values))
    missing = np.where(inside, np.abs(left), np.abs(deviation)).sum(axis=1) / total
    enough = inside.sum(axis=1) >= max(_FEWEST, _SMALLEST_SHARE * len(values))
    return np.where(enough, np.minimum(missing, 1.0), 1.0)


def _refined(clock: Floats, force: Floats, moments: Floats, values: Floats, offset: float, every: float) -> ClockOffset:
    """Refine an offset by robust least squares, by one time between frames at most in an iteration."""
    weights = np.ones(len(moments))
    found = ClockOffset(offset, math.inf, 0.0)
    for _ in range(_ITERATIONS):
        at = moments - found.offset
        inside = (at >= clock[0]) & (at <= clock[-1])
        if inside.sum() < _FEWEST:
            return found._replace(standard_deviation=math.inf)
        ends = np.interp(at + 0.5 * every, clock, force), np.interp(at - 0.5 * every, clock, force)
        basis = np.column_stack([np.interp(at, clock, force), np.ones(len(at))])[inside]
        measured, used = values[inside], weights[inside]
        roots = np.sqrt(used)
        factors = np.linalg.lstsq(basis * roots[:, np.newaxis], measured * roots, rcond=None)[0]
        left = measured - basis @ factors
        columns = np.column_stack([basis, -factors[0] * (ends[0] - ends[1])[inside] / every])
        lengths = np.sqrt((columns**2).sum(axis=0))
        if not (lengths > 0).all() or np.linalg.cond(columns / lengths) > _WORST_CONDITION:
            return found._replace(standard_deviation=math.inf)
        columns /= lengths
        weighted = columns * used[:, np.newaxis]
        change = float(np.linalg.solve(weighted.T @ columns, weighted.T @ left)[2] / lengths[2])
        spread = np.abs(measured - np.median(measured)).mean()
        scale = max(1.4826 * float(np.median(np.abs(left))), _LEAST_SCALE * float(spread))
        small = np.abs(left) <= _HUBER * scale
        weights = np.ones(len(moments))
        weights[inside] = np.where(small, 1.0, _HUBER * scale / np.maximum(np.abs(left), 1e-300))
        influence = (weights[inside] * left) ** 2
        variance = influence.sum() / max(len(left) - 3, 1) / max(float(small.mean()), 0.1) ** 2
        deviation = math.sqrt(variance * np.linalg.inv(columns.T @ columns)[2, 2]) / lengths[2]
        square = weights[inside] * (measured - np.average(measured, weights=weights[inside])) ** 2
        explained = 1.0 - float((weights[inside] * left**2).sum() / square.sum())
        found = ClockOffset(found.offset + float(np.clip(change, -every, every)), float(deviation), explained)
        if abs(change) < 1e-6 * every:
            break
    return found


def _warn_of_rivals(start: str, offsets: Floats, missing: Floats, best: int, found: ClockOffset) -> None:
    """Warn if another offset, beyond offsets that are clearly worse, explains the signal almost as well."""
    worse = np.flatnonzero(missing > missing[best] + 2.0 * _RIVAL)
    first, last = (worse[worse < best].max(initial=0), worse[worse > best].min(initial=len(offsets) - 1))
    others = [k for k in np.flatnonzero(missing < missing[best] + _RIVAL) if k < first or k > last]
    if others:
        rival = min(others, key=lambda k: float(missing[k]))
        warnings.warn(
            f"{start}the offset {found.offset:.4g} s is not the only one: {offsets[rival]:.4g} s explains the signal "
            "almost as well; check it, or give offset as a number.",
            QualityWarning,
            stacklevel=levels_within_fedic(),
        )
