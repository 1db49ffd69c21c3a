"""The frames of a run measured in this process, one after the other."""

from collections.abc import Iterable, Iterator, Sequence
from functools import partial

from fedic.campaign.frames import read_ahead
from fedic.campaign.frames.series import SeriesFrame
from fedic.campaign.measured import FinishedFrame, Measured, measure_frame
from fedic.campaign.setup import Setup
from fedic.campaign.tracking import Tracked, Tracker
from fedic.correlation import Correlator

__all__ = ["SerialExecutor"]


class SerialExecutor:
    """Measures frames in their order, each read while the one before is measured.

    Parameters
    ----------
    setup : Setup
        What is measured with.
    correlator : Correlator
        The first reference image, prepared.
    """

    def __init__(self, setup: Setup, correlator: Correlator) -> None:
        self._setup = setup
        self._tracker = Tracker(correlator, setup.mesh, setup.mask, setup.prepare, setup.starts, setup.reference_update)

    def restore(self, known: Sequence[Tracked], reference: Tracked | None) -> None:
        """Go on from frames measured before; see `Tracker.restore`."""
        self._tracker.restore(known, reference)

    def measure(self, frames: Iterable[SeriesFrame]) -> Iterator[FinishedFrame]:
        """Measure frames; yield each as soon as it is measured."""
        for loaded in read_ahead(frames):
            outcome = measure_frame(self._tracker, loaded)
            result = outcome.tracked.result if outcome.tracked else None
            yield FinishedFrame(Measured(outcome.record(), result, loaded.image), partial(outcome.data, self._setup))
