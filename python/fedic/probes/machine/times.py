"""Times of a record in seconds: units of time, and date-times in text."""

import re
from collections.abc import Sequence
from datetime import datetime

import numpy as np

from fedic._internal.types import Floats

__all__ = ["seconds_of_moments", "seconds_per_unit"]

_UNITS = {
    1.0: ("s", "sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden"),
    1e-3: ("ms", "msec", "millisecond", "milliseconds", "millisekunden"),
    1e-6: ("us", "µs", "μs", "usec", "microsecond", "microseconds"),
    60.0: ("min", "mins", "minute", "minutes", "minuten"),
    3600.0: ("h", "hr", "hrs", "hour", "hours", "std", "stunden"),
}
_HOURS = re.compile(r"(\d{1,4}):(\d{2}):(\d{2}(?:\.\d+)?)")
_DATES = ("", "%Y-%m-%d ", "%Y/%m/%d ", "%d.%m.%Y ", "%m/%d/%Y ", "%d/%m/%Y ", "%d-%m-%Y ")
_CLOCKS = ("%H:%M:%S.%f", "%H:%M", "%I:%M:%S.%f %p", "%I:%M %p")


def seconds_per_unit(unit: str) -> float | None:
    """Return the length of a unit of time.

    Parameters
    ----------
    unit : str
        The unit, such as ``"ms"``.

    Returns
    -------
    float or None
        In seconds; None if it is not a unit of time.
    """
    name = unit.strip(" .").lower()
    return next((seconds for seconds, names in _UNITS.items() if name in names), None)


def seconds_of_moments(texts: Sequence[str]) -> Floats | None:
    """Return the times of date-times, or of hours, minutes and seconds, counted from the first.

    Parameters
    ----------
    texts : sequence of str
        Such as ``"2026-03-01 14:05:33.25"``, ``"01.03.2026 14:05:33,25"`` or ``"14:05:33"``.

    Returns
    -------
    ndarray, shape (n,), or None
        In seconds; None if the texts do not follow one pattern, or patterns with unlike results.
    """
    cleaned = [" ".join(_cleaned(text).split()) for text in texts]
    hours = [_HOURS.fullmatch(text) for text in cleaned]
    if all(hours):
        parts = np.array([[float(part) for part in match.groups()] for match in hours if match])
        elapsed = parts @ [3600.0, 60.0, 1.0]
        return np.asarray(elapsed - elapsed[0])
    found: list[Floats] = []
    for pattern in (date + clock for date in _DATES for clock in _CLOCKS):
        if _parsed([cleaned[0], cleaned[-1]], pattern) is None:
            continue
        seconds = _parsed(cleaned, pattern)
        if seconds is not None and not any(np.allclose(seconds, each, rtol=0.0, atol=1e-9) for each in found):
            found.append(seconds)
    return found[0] if len(found) == 1 else None


def _cleaned(text: str) -> str:
    """Return a text with a decimal point and microseconds at most, without the T and Z of ISO 8601."""
    return re.sub(r"(\.\d{6})\d+", r"\1", re.sub(r"(?<=\d)T(?=\d)", " ", text).replace(",", ".").removesuffix("Z"))


def _parsed(texts: Sequence[str], pattern: str) -> Floats | None:
    whole = pattern.replace(".%f", "")  # whole seconds are written without a fraction
    try:
        moments = [datetime.strptime(text, pattern if "." in text.rpartition(":")[-1] else whole) for text in texts]
    except ValueError:
        return None
    return np.array([(moment - moments[0]).total_seconds() for moment in moments])
