"""The record of a testing machine: its clock in seconds, and its channels."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fedic._internal.types import Floats, StrPath
from fedic.errors import FedicError, OptionError
from fedic.probes.machine.text_table import name_and_unit, number, read_text_table
from fedic.probes.machine.times import seconds_of_moments, seconds_per_unit

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Record", "read_record"]


@dataclass(frozen=True, eq=False)
class Record:
    """A record of a testing machine.

    Attributes
    ----------
    source : str
        What it was read from, as messages name it.
    times : ndarray, shape (n,)
        Increasing, in seconds.
    channels : dict of str to ndarray, shape (n,)
        Values of each channel; NaN in cells without a number.
    units : dict of str to str
        Unit of each channel; empty if it is not known.
    rows : list of str
        Place of each row in its source, as messages name it.
    error : type of FedicError
        What is raised for faults of the source.
    texts : tuple of str
        Columns without numbers.
    """

    source: str
    times: Floats
    channels: dict[str, Floats]
    units: dict[str, str]
    rows: list[str]
    error: type[FedicError] = FedicError
    texts: tuple[str, ...] = ()

    def find(self, name: str, argument: str) -> str:
        """Return the name of a channel.

        Parameters
        ----------
        name : str
            The channel, with or without its unit, in upper or lower case.
        argument : str
            Argument that messages name.

        Returns
        -------
        str
            Its key in `channels`.

        Raises
        ------
        OptionError
            If there is no such column.
        FedicError
            If it holds no numbers.
        """
        found = _find(self.source, [*self.channels, *self.texts], name, argument)
        if found in self.texts:
            raise self.error(f"{self.source}: the column {found!r} holds no numbers.")
        return found


@dataclass(frozen=True, eq=False)
class _Columns:
    """Columns before their meaning is known: texts of a file, or arrays of a table in memory."""

    source: str
    values: dict[str, Any]
    units: dict[str, str]
    rows: list[str]
    error: type[FedicError]


def read_record(
    source: "StrPath | pd.DataFrame",
    time: str,
    units: Mapping[str, str] | None = None,
) -> Record:
    """Read the record of a testing machine.

    Parameters
    ----------
    source : str, path or pandas.DataFrame
        A text file, or a table in memory.
    time : str
        Column of the machine's clock: numbers, or date-times, which are counted from the first row.
    units : mapping of str to str, optional
        Units of columns whose heading has none. Numbers of the clock without a unit are seconds.

    Returns
    -------
    Record
        The record.

    Raises
    ------
    OptionError
        If a column does not exist, or a unit contradicts that of the file or is none of time.
    FedicError
        If the file cannot be used, or the times do not increase.
    """
    table = _read(source)
    clock = _find(table.source, list(table.values), time, "time")
    given = {_find(table.source, list(table.values), name, "units"): unit for name, unit in (units or {}).items()}
    for name, unit in given.items():
        if table.units[name] and not _is_same(unit, table.units[name]):
            raise OptionError(
                f"units gives {name!r} in {unit!r}, and {table.source} says {table.units[name]!r}; leave it out or "
                "correct the heading of the file.",
                "units",
            )
    all_units = {**table.units, **given}
    times = _times(table, clock, all_units[clock])
    numbers = {name: _numbers(values) for name, values in table.values.items() if name != clock}
    channels = {name: values for name, values in numbers.items() if np.isfinite(values).any()}
    texts = tuple(name for name in numbers if name not in channels)
    return Record(
        table.source, times, channels, {name: all_units[name] for name in channels}, table.rows, table.error, texts
    )


def _find(source: str, columns: Sequence[str], name: str, argument: str) -> str:
    """Return the name of a column, given with or without its unit and in upper or lower case."""
    short = name_and_unit(name)[0].lower() if isinstance(name, str) else name
    for found in (
        [each for each in columns if each == name],
        [each for each in columns if each.lower() in (str(name).lower(), short)],
    ):
        if len(found) == 1:
            return found[0]
    known = ", ".join(repr(each) for each in columns)
    raise OptionError(f"{argument}: {source} has no column {name!r}; its columns are {known}.", argument)


def _read(source: "StrPath | pd.DataFrame") -> _Columns:
    if hasattr(source, "columns") and hasattr(source, "iloc"):
        return _of_table(source)
    try:
        path = Path(source)
    except TypeError as error:
        raise OptionError(
            f"the record of the machine must be a file or a pandas.DataFrame, got {source!r}.", "source"
        ) from error
    table = read_text_table(path)
    fields = dict(zip(table.names, zip(*table.rows, strict=True), strict=True))
    units = dict(zip(table.names, table.units, strict=True))
    return _Columns(str(path), fields, units, [f"line {line}" for line in table.lines], FedicError)


def _of_table(table: Any) -> _Columns:
    if not len(table):
        raise OptionError("the table of the machine has no rows.", "source")
    for column in table.columns[table.columns.duplicated()][:1]:
        raise OptionError(
            f"the table of the machine has two columns {column!r}; give each a name of its own.", "source"
        )
    values, units = {}, {}
    for column in table.columns:
        name, unit = name_and_unit(str(column))
        name = str(column) if name in values else name
        values[name], units[name] = table[column], unit
    rows = [f"row {index}" for index in range(len(table))]
    return _Columns("the table of the machine", values, units, rows, OptionError)


def _numbers(values: Any) -> Floats:
    if hasattr(values, "to_numpy"):
        from pandas.api.types import is_bool_dtype, is_numeric_dtype

        if not is_numeric_dtype(values.dtype) or is_bool_dtype(values.dtype):
            return np.array([number(str(value).strip()) for value in values])
        found = values.to_numpy(dtype=np.float64, na_value=np.nan)
        return np.where(np.isfinite(found), found, np.nan)
    return np.array([number(text) for text in values])


def _times(table: _Columns, clock: str, unit: str) -> Floats:
    values = table.values[clock]
    if str(getattr(values, "dtype", "")).startswith(("datetime64", "timedelta64")):
        times = np.asarray((values - values.iloc[0]).dt.total_seconds(), dtype=np.float64)
        scale: float | None = 1.0
    else:
        times = _numbers(values)
        scale = seconds_per_unit(unit) if unit else 1.0
        if not np.isfinite(times).any():
            moments = seconds_of_moments([str(value).strip() for value in values])
            if moments is None:
                raise table.error(
                    f"{table.source}: the column {clock!r} holds neither numbers nor date-times of one clear pattern: "
                    f"{table.rows[0]} has {str(values[0] if isinstance(values, tuple) else values.iloc[0])!r}; write "
                    "them as 2026-03-01 14:05:33.25."
                )
            times, scale = moments, 1.0
    if scale is None:
        raise OptionError(
            f"time={clock!r}: its unit {unit!r} in {table.source} is not a unit of time; name the column of the clock, "
            "in us, ms, s, min or h.",
            "time",
        )
    for row in np.flatnonzero(~np.isfinite(times))[:1]:
        raise table.error(f"{table.source}: the column {clock!r} has no time in {table.rows[row]}; remove the row.")
    for row in np.flatnonzero(np.diff(times) <= 0)[:1]:
        raise table.error(
            f"{table.source}: the times of {clock!r} must increase, and {table.rows[row + 1]} has {times[row + 1]:g} "
            f"after {times[row]:g}; remove repeated rows, or write the times with more digits."
        )
    return times * scale


def _is_same(one: str, other: str) -> bool:
    seconds = seconds_per_unit(one)
    return one.strip().lower() == other.strip().lower() or (seconds is not None and seconds == seconds_per_unit(other))
