"""Times of frames: given, or those of their files."""

import datetime
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fedic._internal.types import Floats
from fedic.errors import OptionError
from fedic.io.images import split_page

__all__ = ["Times", "checked_times", "file_time"]

Times: TypeAlias = Literal["modified", "recorded"] | float | ArrayLike

_EXIF, _DATE_TIME, _ORIGINAL, _FRACTION, _ORIGINAL_FRACTION = 0x8769, 0x0132, 0x9003, 0x9290, 0x9291


def checked_times(times: Times | None, count: int | None) -> Literal["modified", "recorded"] | float | Floats | None:
    """Check the times of the frames of a series.

    Parameters
    ----------
    times : {"modified", "recorded"}, float, array_like of shape (count,), or None
        Where they come from: the files, the frames per second, or the times themselves in seconds.
    count : int or None
        Number of frames; None if it is not known.

    Returns
    -------
    str, float, ndarray or None
        The same, as an array if they were given.

    Raises
    ------
    OptionError
        If they are something else, or do not increase.
    """
    if times is None or (isinstance(times, str) and times in ("modified", "recorded")):
        return times  # type: ignore[return-value]
    if isinstance(times, str):
        raise OptionError(
            f"times={times!r}: give 'modified' (the files' times of modification), 'recorded' (the times that cameras "
            "write into their files), the frames per second, or one time per frame in seconds",
            "times",
        )
    try:
        given = np.asarray(times, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise OptionError(f"times is not an array of numbers ({error})", "times") from error
    if given.ndim == 0:
        rate = float(given)
        if not (math.isfinite(rate) and rate > 0):
            raise OptionError(f"times={rate}: frames per second must be greater than zero", "times")
        return rate
    if given.ndim != 1 or (count is not None and len(given) != count):
        expected = "one per frame" if count is None else f"one for each of the {count} frames"
        raise OptionError(f"times has shape {given.shape}; give {expected}", "times")
    backwards = np.flatnonzero(~(np.diff(given) > 0))
    if backwards.size or not np.isfinite(given).all():
        where = f" (frame {backwards[0] + 1})" if backwards.size else ""
        raise OptionError(f"times must be finite and increase from frame to frame{where}", "times")
    return given


def file_time(files: Sequence[Path], kind: Literal["modified", "recorded"]) -> float:
    """Return the mean of the times of files, in seconds since 1970.

    Parameters
    ----------
    files : sequence of Path
        Image files; their names may have a page.
    kind : {"modified", "recorded"}
        ``"recorded"``: the EXIF or TIFF tag ``DateTimeOriginal`` or ``DateTime`` with its fraction of a second, taken
        as UTC; ``"modified"``: the time of the last modification, which a copy may change.

    Returns
    -------
    float
        NaN if a file is missing or does not tell.
    """
    find = _modified if kind == "modified" else _recorded
    times = [find(split_page(file)[0]) for file in files]
    return float(np.mean(times)) if times else math.nan


def _modified(file: Path) -> float:
    try:
        return file.stat().st_mtime_ns * 1e-9
    except OSError:
        return math.nan


def _recorded(file: Path) -> float:
    from PIL import Image

    try:
        with Image.open(file) as image:
            tags = image.getexif()
            details = tags.get_ifd(_EXIF)
    except Exception:  # Pillow raises errors of many types for damaged files, which reading them names
        return math.nan
    original = details.get(_ORIGINAL) or tags.get(_ORIGINAL)
    text = original or tags.get(_DATE_TIME)
    fraction = details.get(_ORIGINAL_FRACTION if original else _FRACTION)
    try:
        stamp = datetime.datetime.strptime(str(text).strip("\0 "), "%Y:%m:%d %H:%M:%S")
        after = float(f"0.{str(fraction).strip(chr(0) + ' ')}") if fraction else 0.0
    except ValueError:
        return math.nan
    return stamp.replace(tzinfo=datetime.timezone.utc).timestamp() + after
