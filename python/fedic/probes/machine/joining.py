"""Channels of a testing machine at the times of the frames."""

import math
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._internal.optional import optional_module
from fedic._internal.types import Floats, StrPath
from fedic._internal.warning_level import levels_within_fedic
from fedic.errors import OptionError, QualityWarning
from fedic.probes.machine.clock import ClockOffset, find_offset
from fedic.probes.machine.record import Record, read_record
from fedic.probes.series import FrameInfo, Series

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["join"]

_GAP_STEPS = 5.0
_GAP_FRAMES = 0.1
_LISTED = 5
"""Number of frames that a warning names."""


def join(
    series: Series,
    source: "StrPath | pd.DataFrame",
    *,
    time: str,
    offset: float | Literal["auto"] = 0.0,
    correlate: tuple[str, ArrayLike] | None = None,
    columns: Sequence[str] | None = None,
    units: Mapping[str, str] | None = None,
    gap: float | None = None,
) -> "pd.DataFrame":
    """Interpolate the channels of a testing machine at the times of the frames.

    Parameters
    ----------
    series : Series
        The frames.
    source : str, path or pandas.DataFrame
        Record of the machine: a text file with tabs, semicolons or commas, decimal points or commas, any lines above
        the names, and units in a line below the names or behind them, ``Load (kN)``; or a table.
    time : str
        Column of the machine's clock: times in us, ms, s, min or h, seconds if no unit is given; or date-times, which
        are counted in seconds from the first row.
    offset : float or "auto"
        Seconds that are added to the machine's clock to give that of the frames. ``"auto"`` finds it from `correlate`.
    correlate : tuple of str and array_like, optional
        A channel and a measured signal that is proportional to it, one value a frame or a column of a table of the
        series: the offset is the one at which the channel explains the signal best; see docs/probes.md.
    columns : sequence of str, optional
        Channels to take; by default all that hold numbers.
    units : mapping of str to str, optional
        Units of columns whose heading has none, such as ``{"Time": "ms"}``.
    gap : float, optional
        Longest step of the record, in seconds, over which channels are interpolated; by default five times the median
        step, and not less than a tenth of the median time between frames.

    Returns
    -------
    pandas.DataFrame
        Its index ``frame`` is that of tables of the series. Column ``machine_time``, the time of the frame on the
        machine's clock in seconds, then the channels, linear between the rows of the record. ``attrs`` holds ``units``
        by channel, ``offset`` and ``offset_std`` (NaN if the offset was given).

    Raises
    ------
    OptionError
        If an argument or a column is unknown, a unit contradicts the file, no frame has a time, the frames and the
        record do not overlap, or the signals do not determine the offset.
    FedicError
        If the file cannot be used, its times do not increase, or pandas is not installed.

    Warns
    -----
    QualityWarning
        If frames are NaN: they have no time, or lie outside the record, in a gap or beside a cell without a number; or
        if another offset explains the signal almost as well.
    """
    pandas = optional_module("pandas", "tables", "machine data")
    frames = list(series.frames)
    moments = np.array([frame.time for frame in frames], dtype=np.float64)
    _check_arguments(moments, offset, correlate, gap)
    record = read_record(source, time, units)
    names = list(record.channels) if columns is None else [record.find(name, "columns") for name in columns]
    clock = ClockOffset(float(offset), math.nan, math.nan) if offset != "auto" else _found(record, moments, correlate)
    at = moments - clock.offset
    _check_overlap(record, moments, at)
    longest = _default_gap(record.times, moments) if gap is None else float(gap)
    place = _placed(record.times, at)
    values = {name: _interpolated(record.channels[name], place) for name in names}
    _warn_of_faults(record, frames, values, place, longest)
    for channel in values.values():
        channel[place.step > longest] = np.nan
    index = pandas.Index([frame.index for frame in frames], name="frame", dtype="int64")
    found: pd.DataFrame = pandas.DataFrame({"machine_time": at, **values}, index=index)
    found.attrs.update(
        units={name: record.units[name] for name in names}, offset=clock.offset, offset_std=clock.standard_deviation
    )
    return found


class _Place(NamedTuple):
    """Places of frames in a record: the row before, that after, the share of the way, and the step; NaN outside."""

    before: NDArray[np.int64]
    after: NDArray[np.int64]
    share: Floats
    step: Floats


def _check_arguments(
    moments: Floats, offset: object, correlate: tuple[str, ArrayLike] | None, gap: float | None
) -> None:
    if not np.isfinite(moments).any():
        raise OptionError("no frame of the series has a time: give the times of the frames to the campaign.", "series")
    if (offset == "auto") != (correlate is not None):
        raise OptionError(
            'offset="auto" needs correlate=(channel, measured signal), and only with it: name a channel of the machine '
            "and give a signal that is proportional to it, one value a frame.",
            "correlate",
        )
    is_number = isinstance(offset, (int, float, np.number)) and not isinstance(offset, bool)
    if offset != "auto" and not (is_number and math.isfinite(float(offset))):  # type: ignore[arg-type]
        raise OptionError(f'offset={offset!r}: give seconds, or "auto".', "offset")
    if gap is not None and not gap > 0:
        raise OptionError(f"gap={gap!r}: give the longest step of the record in seconds, more than 0.", "gap")


def _found(record: Record, moments: Floats, correlate: tuple[str, ArrayLike] | None) -> ClockOffset:
    assert correlate is not None
    name = record.find(correlate[0], "correlate")
    signal = np.asarray(correlate[1], dtype=np.float64)
    if signal.shape != moments.shape:
        raise OptionError(
            f"correlate: the measured signal has shape {signal.shape}; give one value for each of the "
            f"{len(moments)} frames.",
            "correlate",
        )
    return find_offset(record.times, record.channels[name], moments, signal, f"channel {name!r}: ")


def _check_overlap(record: Record, moments: Floats, at: Floats) -> None:
    first, last = record.times[[0, -1]]
    if ((at >= first) & (at <= last)).any():
        return
    shift = float(np.nanmin(moments) - first)
    raise OptionError(
        f"{record.source}: the clocks do not overlap: on the machine's clock the frames are at {np.nanmin(at):.6g} to "
        f"{np.nanmax(at):.6g} s, and its record reaches from {first:.6g} to {last:.6g} s; give offset, the seconds "
        f'added to the machine\'s clock, such as {shift:.6g} if both begin together, or "auto" with correlate.',
        "offset",
    )


def _default_gap(times: Floats, moments: Floats) -> float:
    known = np.sort(moments[np.isfinite(moments)])
    every = float(np.median(np.diff(known))) if len(known) > 1 else 0.0
    step = float(np.median(np.diff(times))) if len(times) > 1 else 0.0
    return max(_GAP_STEPS * step, _GAP_FRAMES * every)


def _placed(times: Floats, at: Floats) -> _Place:
    slack = 1e-9 * max(float(np.ptp(times)), float(np.abs(times).max()))
    inside = (at >= times[0] - slack) & (at <= times[-1] + slack)
    clipped = np.clip(np.where(inside, at, times[0]), times[0], times[-1])
    before = np.clip(np.searchsorted(times, clipped, side="right") - 1, 0, max(len(times) - 2, 0))
    after = np.minimum(before + 1, len(times) - 1)
    step = times[after] - times[before]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(step > 0, (clipped - times[before]) / step, 0.0)
    # A frame at the time of a row needs that row only.
    row = np.where(share == 0.0, before, after)
    exact = (share == 0.0) | (share == 1.0)
    before, after = (np.where(exact, row, each) for each in (before, after))
    return _Place(before, after, np.where(inside, share, np.nan), np.where(exact, 0.0, step))


def _interpolated(values: Floats, place: _Place) -> Floats:
    return (1.0 - place.share) * values[place.before] + place.share * values[place.after]


def _warn_of_faults(
    record: Record, frames: Sequence[FrameInfo], values: Mapping[str, Floats], place: _Place, longest: float
) -> None:
    """Warn of frames that are NaN, with the reason."""
    timeless = np.array([math.isnan(frame.time) for frame in frames])
    outside = np.isnan(place.share) & ~timeless
    gaps = (place.step > longest) & ~timeless & ~outside
    first, last = record.times[[0, -1]]
    faults = [
        (timeless, "have no time"),
        (outside, f"lie outside the record, which reaches from {first:.6g} to {last:.6g} s on the machine's clock"),
        (gaps, f"lie in a step of the record longer than {longest:.3g} s; gap sets the longest one"),
    ]
    for name, channel in values.items():
        beside = np.isnan(channel) & ~timeless & ~outside & ~gaps
        rows = [k for k in (*place.before[beside], *place.after[beside]) if np.isnan(record.channels[name][k])]
        cell = record.rows[min(rows)] if rows else ""
        faults.append((beside, f"lie beside a cell of {name!r} without a number, the first in {cell}"))
    clauses = [f"{_listed(frames, faulty)} {reason}" for faulty, reason in faults if faulty.any()]
    if clauses:
        warnings.warn(
            f"{record.source}: frames without machine data are NaN: {'; '.join(clauses)}.",
            QualityWarning,
            stacklevel=levels_within_fedic(),
        )


def _listed(frames: Sequence[FrameInfo], chosen: NDArray[np.bool_]) -> str:
    names = [frame.name for frame, is_chosen in zip(frames, chosen, strict=True) if is_chosen]
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return f"{', '.join(names[:_LISTED])}{more}"
