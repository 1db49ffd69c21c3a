"""The frames of a series, by number where they can be loaded again, else one after the other."""

import glob
import math
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fedic.campaign.frames.entry import FrameEntry, checked_entry, entry_files, entry_name
from fedic.campaign.frames.image_list import natural_order
from fedic.campaign.frames.times import Times, checked_times, file_time
from fedic.campaign.frames.videos import VideoFrames, is_video
from fedic.errors import OptionError

__all__ = ["FrameSeries", "SeriesFrame"]

_NUMBER = re.compile(r"%0?(\d*)d")


@dataclass(frozen=True, eq=False)
class SeriesFrame:
    """A frame that was not loaded yet.

    Attributes
    ----------
    index : int
        Its number, from 0.
    name : str
        Its name: that of its file without the ending, or ``"frame 12"``.
    time : float
        Its time in seconds; NaN if it is not known.
    entry : FrameEntry
        Its file or files, or its array.
    """

    index: int
    name: str
    time: float
    entry: FrameEntry


class FrameSeries:
    """The frames of a series.

    Parameters
    ----------
    frames : str, Path, sequence or iterable
        A pattern such as ``"images/frame_*.tif"``, a numbered one such as ``"images/frame_%04d.tif"``, a video file, a
        sequence of files, arrays or lists of static images, or an iterable of arrays.
    times : optional
        See `checked_times`.

    Raises
    ------
    OptionError
        If they are something else, or there are none.
    """

    def __init__(self, frames: Any, times: Times | None = None) -> None:
        self._entries: list[FrameEntry] | None = None
        self._stream: Iterable[Any] | None = None
        if isinstance(frames, (str, Path)) and is_video(Path(frames)):
            self._stream = VideoFrames(Path(frames))
        elif isinstance(frames, (str, Path)):
            self._entries = list(_matches(str(frames)))
        elif isinstance(frames, (Sequence, np.ndarray)):
            self._entries = [checked_entry(entry, f"frame {index}") for index, entry in enumerate(frames)]
            if not self._entries:
                raise OptionError("frames is empty; give at least one deformed image", "frames")
        elif isinstance(frames, Iterable):
            self._stream = frames
        else:
            raise OptionError(
                f"frames is a {type(frames).__name__}; give a pattern of file names, a list of files or arrays, a "
                "video file, or an iterator of arrays",
                "frames",
            )
        self._times = checked_times(times, self.count)
        if self._entries is None and isinstance(self._times, str):
            raise OptionError(f"times={self._times!r} needs image files; these frames are arrays", "times")

    @property
    def count(self) -> int | None:
        """Number of frames; None if it is not known before the last one."""
        return None if self._entries is None else len(self._entries)

    @property
    def entries(self) -> list[FrameEntry] | None:
        """The frames that can be loaded in any order; None for a stream of arrays."""
        return self._entries

    def frame(self, index: int) -> SeriesFrame:
        """Return a frame of a series that can be loaded in any order."""
        assert self._entries is not None, "a stream has no frames by number"
        entry = self._entries[index]
        return SeriesFrame(index, entry_name(entry, index), self._time(index, entry), entry)

    def __iter__(self) -> Iterator[SeriesFrame]:
        if self._entries is not None:
            yield from map(self.frame, range(len(self._entries)))
            return
        assert self._stream is not None, "a series is a list or a stream"
        for index, given in enumerate(self._stream):
            time, image = given if isinstance(given, tuple) and len(given) == 2 else (math.nan, given)
            # The buffer of a camera may be filled again.
            entry = checked_entry(np.array(image), f"frame {index}")
            own = self._time(index, entry)
            yield SeriesFrame(index, entry_name(entry, index), float(time) if math.isnan(own) else own, entry)

    def _time(self, index: int, entry: FrameEntry) -> float:
        if self._times is None:
            return math.nan
        if isinstance(self._times, str):
            return file_time(entry_files(entry), self._times)
        if isinstance(self._times, float):
            return index / self._times
        return float(self._times[index]) if index < len(self._times) else math.nan


def _matches(pattern: str) -> Iterator[str]:
    """Yield the files that a pattern stands for; of a numbered one, those that are missing between two others too."""
    number = _NUMBER.search(os.path.basename(pattern))  # noqa: PTH119 - a pattern, not a path
    found = sorted(glob.glob(pattern if number is None else _as_glob(pattern)), key=natural_order)  # noqa: PTH207
    if number is None:
        if not found:
            raise OptionError(f"frames={pattern!r} matches no file", "frames")
        yield from found
        return
    expression = re.compile("(\\d+)".join(map(re.escape, _NUMBER.split(pattern)[::2])), re.DOTALL)
    numbers = [int(match[1]) for match in map(expression.fullmatch, found) if match is not None]
    numbers = [each for each in numbers if pattern % each in found]
    if not numbers:
        raise OptionError(f"frames={pattern!r} matches no file", "frames")
    yield from (pattern % each for each in range(min(numbers), max(numbers) + 1))


def _as_glob(pattern: str) -> str:
    head, tail = os.path.split(pattern)
    return os.path.join(glob.escape(head), "*".join(map(glob.escape, _NUMBER.split(tail)[::2])))  # noqa: PTH118
