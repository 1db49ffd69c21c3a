"""The measurement of one frame, and what it hands on."""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from fedic._internal.types import Image
from fedic.campaign.frames import LoadedFrame
from fedic.campaign.frames.series import SeriesFrame
from fedic.campaign.record import FrameRecord
from fedic.campaign.setup import Setup
from fedic.campaign.store import FrameData, of_failed_frame, of_result
from fedic.campaign.tracking import Tracked, Tracker
from fedic.errors import FedicError
from fedic.results import Result

__all__ = ["Executor", "FinishedFrame", "Measured", "Outcome", "measure_frame"]


class Measured(NamedTuple):
    """A frame of a run.

    Attributes
    ----------
    record : FrameRecord
        What is known of it besides its fields.
    result : Result or None
        Its result; None if it could not be measured.
    image : ndarray, shape (height, width), or None
        Its image; None if it could not be read, or was read from a file by a Dask worker.
    """

    record: FrameRecord
    result: Result | None
    image: Image | None


@dataclass(frozen=True, eq=False)
class FinishedFrame:
    """A frame that is ready to be written.

    Attributes
    ----------
    measured : Measured
        What the run yields.
    data : callable
        Returns what is stored of it.
    """

    measured: Measured
    data: Callable[[], FrameData]


class Executor(Protocol):
    """Measures the frames of a run: in this process, or on workers."""

    def restore(self, known: Sequence[Tracked], reference: Tracked | None) -> None:
        """Go on from frames measured before; see `Tracker.restore`."""

    def measure(self, frames: Iterable[SeriesFrame]) -> Iterator[FinishedFrame]:
        """Measure frames; yield them in their order."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """What became of a frame.

    Attributes
    ----------
    frame : SeriesFrame
        The frame.
    tracked : Tracked or None
        What was measured.
    error : str
        Why nothing was.
    seconds : float
        Time that it took.
    """

    frame: SeriesFrame
    tracked: Tracked | None
    error: str
    seconds: float

    def data(self, setup: Setup) -> FrameData:
        """Return what is stored of the frame."""
        frame, tracked = self.frame, self.tracked
        measure, has_drift = setup.strain_measure, setup.reference_update != "first"
        if tracked is None:
            return of_failed_frame(frame, self.error, setup.mesh, measure, has_drift=has_drift)
        return of_result(frame, tracked.result, measure, tracked.reference, tracked.drift, has_drift=has_drift)

    def record(self) -> FrameRecord:
        """Return what is known of the frame besides its fields."""
        frame, tracked = self.frame, self.tracked
        if tracked is None:
            nan = float("nan")
            return FrameRecord(
                frame.index, frame.name, frame.time, self.error, False, False, nan, nan, 0, "", -1, self.seconds
            )
        result = tracked.result
        return FrameRecord(
            frame.index,
            frame.name,
            frame.time,
            "",
            result.converged,
            result.quality.is_good,
            result.residual_rms,
            result.quality.noise,
            result.iterations,
            result.start,
            tracked.reference,
            self.seconds,
        )


def measure_frame(tracker: Tracker, loaded: LoadedFrame) -> Outcome:
    """Measure a frame; a fault of it becomes its error.

    Parameters
    ----------
    tracker : Tracker
        Measures.
    loaded : LoadedFrame
        The frame.

    Returns
    -------
    Outcome
        What became of it.
    """
    start = time.perf_counter()
    error = loaded.error
    tracked: Tracked | None = None
    if loaded.image is not None:
        try:
            tracked = tracker.measure(loaded.frame.index, loaded.image)
        except FedicError as fault:
            error = str(fault)
        except MemoryError:
            error = "there is not enough memory for this frame; give a coarser mesh or smaller images."
    return Outcome(loaded.frame, tracked, error, time.perf_counter() - start)
