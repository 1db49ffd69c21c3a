"""What runs on a worker: the reference image is prepared once, and blocks of frames are measured.

Workers import this module; it needs the package ``distributed``.
"""

import signal
import threading
from dataclasses import dataclass, replace
from typing import Any

from distributed import WorkerPlugin, get_worker

from fedic._core import __version__
from fedic._internal.types import Image
from fedic.campaign.cluster.blocks import Block
from fedic.campaign.cluster.reference import SentReference
from fedic.campaign.frames.read_ahead import load
from fedic.campaign.measured import measure_frame
from fedic.campaign.record import FrameRecord
from fedic.campaign.setup import Setup
from fedic.campaign.store import FrameData
from fedic.campaign.tracking import Tracker
from fedic.correlation import Correlator
from fedic.errors import FedicError

__all__ = ["MeasuringPlugin", "SentFrame", "dask_setup", "installed_version", "measure_block"]


@dataclass(frozen=True, eq=False)
class SentFrame:
    """A measured frame as it is sent back.

    Attributes
    ----------
    record : FrameRecord
        What is known of it besides its fields.
    data : FrameData
        What is stored of it.
    """

    record: FrameRecord
    data: FrameData


class MeasuringPlugin(WorkerPlugin):
    """Gives each worker what it measures with, also one that comes later or replaces a lost one.

    Parameters
    ----------
    name : str
        Name under which `measure_block` finds it.
    setup : Setup
        What is measured with.
    reference : SentReference
        The reference image.
    version : str
        Version of fedic that the workers must have.
    """

    def __init__(self, name: str, setup: Setup, reference: SentReference, version: str) -> None:
        self.name = name
        self._setup, self._reference, self._version = setup, reference, version
        self._measurement: _Measurement | None = None

    def setup(self, worker: Any) -> None:
        """Take what is measured with into use on a worker.

        Raises
        ------
        FedicError
            If the worker has another version of fedic, or another reference image.
        """
        if self._version != __version__:
            raise FedicError(f"this worker has fedic {__version__}, and the run is of fedic {self._version}.")
        options = {"num_threads": worker.state.nthreads, **self._setup.options}
        self._measurement = _Measurement(replace(self._setup, options=options), self._reference.image())

    def measure(self, block: Block) -> list[SentFrame]:
        """Measure a block of frames."""
        assert self._measurement is not None, "the worker has set this plugin up before it gets tasks"
        return self._measurement.measure(block)


class _Measurement:
    """Measures one block at a time, so that the memory of a worker does not depend on the number of its threads."""

    def __init__(self, setup: Setup, reference: Image) -> None:
        self._setup, self._reference = setup, reference
        self._correlator: Correlator | None = None
        self._lock = threading.Lock()

    def measure(self, block: Block) -> list[SentFrame]:
        with self._lock:
            setup = self._setup
            if self._correlator is None:
                self._correlator = setup.prepare(self._reference, setup.mesh, setup.mask)
            tracker = Tracker(
                self._correlator, setup.mesh, setup.mask, setup.prepare, setup.starts, setup.reference_update
            )
            tracker.restore(block.known, None)
            outcomes = (measure_frame(tracker, load(frame)) for frame in block.frames)
            return [SentFrame(outcome.record(), outcome.data(setup)) for outcome in outcomes]


def measure_block(name: str, block: Block) -> list[SentFrame]:
    """Measure a block of frames on the worker that runs this task.

    Parameters
    ----------
    name : str
        Name of the plugin.
    block : Block
        The frames.

    Returns
    -------
    list of SentFrame
        The frames, failed ones too.
    """
    plugin: Any = get_worker().plugins[name]
    frames: list[SentFrame] = plugin.measure(block)
    return frames


def installed_version() -> str:
    """Return the version of fedic of this process."""
    return __version__


def dask_setup(worker: Any) -> None:
    """Leave Ctrl-C to the process that has started this worker; Dask calls this where the module is preloaded."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
