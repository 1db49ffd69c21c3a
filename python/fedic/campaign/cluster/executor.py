"""The frames of a run measured on Dask workers, and handed on in their order."""

import contextlib
import threading
import time
import uuid
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

from fedic._core import __version__
from fedic._internal.types import Image
from fedic.campaign.cluster.blocks import Block, blocks, travelling
from fedic.campaign.cluster.connection import Cluster, connected, distributed_module
from fedic.campaign.cluster.reference import SentReference, is_readable
from fedic.campaign.frames import FrameEntry, load_entry
from fedic.campaign.frames.entry import entry_files, image_count
from fedic.campaign.frames.series import SeriesFrame
from fedic.campaign.measured import FinishedFrame, Measured, Outcome
from fedic.campaign.results import StoredResults
from fedic.campaign.setup import Setup
from fedic.campaign.tracking import Tracked
from fedic.errors import FedicError
from fedic.io.image_origins import sample_checksum

__all__ = ["cluster_executor"]

_BLOCKS_PER_WORKER = 2
"""Blocks that are measured or wait at a worker."""
_PATIENCE = 60.0
"""Seconds without any worker after which a run ends."""
_GLANCE = 1.0
"""Seconds between two looks at the workers."""
_TOGETHER = 0.2
"""Seconds in which the scheduler reports all blocks of a lost worker."""


@contextmanager
def cluster_executor(
    cluster: Cluster, setup: Setup, reference: FrameEntry, image: Image, results: StoredResults
) -> Iterator["_ClusterExecutor"]:
    """Provide workers that are ready to measure.

    Parameters
    ----------
    cluster : str or distributed.Client
        Accepted by `check_cluster`.
    setup : Setup
        What is measured with.
    reference : FrameEntry
        The reference image.
    image : ndarray, shape (height, width)
        The same, loaded.
    results : StoredResults
        Makes results of what the workers send back.

    Yields
    ------
    Executor
        Measures frames.

    Raises
    ------
    FedicError
        If there are no workers, or they cannot be used.
    """
    distributed = distributed_module()
    from fedic.campaign.cluster.worker import MeasuringPlugin, installed_version

    with connected(cluster) as client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except distributed.TimeoutError:
            raise _no_workers() from None
        for version in _answers(client, installed_version):
            if version != __version__:
                raise FedicError(
                    f"the workers have fedic {version}, and this is fedic {__version__}, which may measure other bits; "
                    "install the same version everywhere."
                )
        name = f"fedic-{uuid.uuid4().hex}"
        try:
            client.register_plugin(MeasuringPlugin(name, setup, _sent(client, reference, image), __version__), name)
            yield _ClusterExecutor(client, name, setup, results)
        finally:
            with _without_scheduler():
                client.unregister_worker_plugin(name)


class _ClusterExecutor:
    """Keeps some blocks at the workers, and yields their frames in order."""

    def __init__(self, client: Any, name: str, setup: Setup, results: StoredResults) -> None:
        self._client, self._name, self._setup, self._results = client, name, setup, results
        self._known: list[Tracked] = []
        self._last_seen = time.monotonic()
        self._is_any_done = threading.Event()
        self._fault: Exception | None = None

    def restore(self, known: Sequence[Tracked], reference: Tracked | None) -> None:
        """Go on from frames measured before; the reference image is always the first one."""
        assert reference is None, "updates of the reference image are refused"
        self._known.extend(known)

    def measure(self, frames: Iterable[SeriesFrame]) -> Iterator[FinishedFrame]:
        """Measure frames; yield them in their order.

        Raises
        ------
        FedicError
            If there are no workers for a long time, or the scheduler is lost.
        """
        waiting = enumerate(blocks(frames, self._setup.starts, self._known))
        running: dict[Any, tuple[int, Block]] = {}
        finished: dict[int, list[FinishedFrame]] = {}
        place = 0
        try:
            while True:
                most = _BLOCKS_PER_WORKER * max(1, self._num_workers())
                while len(running) < most and len(running) + len(finished) < 2 * most:
                    following = self._next(waiting)
                    if following is None:
                        break
                    running[self._submit(following[1])] = following
                if place in finished:
                    yield from finished.pop(place)
                    place += 1
                elif running:
                    finished.update(self._collect(running))
                else:
                    break
        finally:
            with _without_scheduler():
                self._client.cancel(list(running))
        if self._fault is not None:
            raise self._fault

    def _next(self, waiting: Iterator[tuple[int, Block]]) -> tuple[int, Block] | None:
        """Return the next block; an error of the frames is raised once those before are finished."""
        try:
            return next(waiting, None)
        except Exception as error:
            self._fault = error
            return None

    def _submit(self, block: Block) -> Any:
        from fedic.campaign.cluster.worker import measure_block

        with warnings.catch_warnings():
            # Images that have no file are large.
            warnings.filterwarnings("ignore", "Sending large graph", UserWarning)
            # Equal calls are not the same: a file may have changed.
            future = self._client.submit(measure_block, self._name, travelling(block), pure=False)
        future.add_done_callback(lambda _: self._is_any_done.set())
        return future

    def _collect(self, running: dict[Any, tuple[int, Block]]) -> dict[int, list[FinishedFrame]]:
        """Wait for a moment; return the blocks that are finished, and release what the workers hold of them."""
        distributed = distributed_module()
        self._is_any_done.wait(_GLANCE)
        self._is_any_done.clear()
        if any(future.status == "error" for future in running):
            # Of a lost worker all blocks are reported, one after the other.
            time.sleep(_TOGETHER)
        found: dict[int, list[FinishedFrame]] = {}
        killed: list[tuple[int, Block, Any]] = []
        for future in [future for future in running if future.done()]:
            number, block = running[future]
            try:
                found[number] = self._frames(future, block)
            except distributed.TimeoutError:
                # The worker was lost with what it had finished; the block is measured again.
                continue
            except distributed.KilledWorker as error:
                killed.append((number, block, error))
            del running[future]
            future.release()
        killed.sort(key=lambda each: each[0])
        for number, block, fault in killed[:1]:
            found[number] = self._lost(block, fault)
        # A worker measures its blocks in their order: the others were waiting behind the first one.
        for number, block, _ in killed[1:]:
            running[self._submit(block)] = number, block
        return found

    def _frames(self, future: Any, block: Block) -> list[FinishedFrame]:
        """Return the frames of a block that is finished."""
        distributed = distributed_module()
        try:
            sent = future.result(timeout=_GLANCE)
        except (FedicError, distributed.TimeoutError, distributed.KilledWorker):
            raise
        except distributed.CancelledError as error:
            raise _lost_scheduler() from error
        except Exception as error:
            raise FedicError(f"{block.names}: a worker of Dask failed ({type(error).__name__}: {error}).") from error
        return [self._finished(*pair) for pair in zip(block.frames, sent, strict=True)]

    def _finished(self, frame: SeriesFrame, sent: Any) -> FinishedFrame:
        if sent.record.error:
            return FinishedFrame(Measured(sent.record, None, None), lambda: sent.data)
        image = None if entry_files(frame.entry) else load_entry(frame.entry, frame.name)
        result = self._results.result_of(sent.data, image)
        return FinishedFrame(Measured(sent.record, result, image), lambda: sent.data)

    def _lost(self, block: Block, error: Any) -> list[FinishedFrame]:
        """Return the frames of a block that no worker has survived."""
        reason = (
            f"the worker that measured {block.names} was lost {error.allowed_failures + 1} times, killed or out of "
            "memory; give the workers more memory, or measure without Dask."
        )
        outcomes = [Outcome(frame, None, reason, 0.0) for frame in block.frames]
        return [
            FinishedFrame(Measured(outcome.record(), None, None), partial(outcome.data, self._setup))
            for outcome in outcomes
        ]

    def _num_workers(self) -> int:
        """Return the number of workers; raise an error if there have been none for a long time."""
        try:
            count = len(self._client.nthreads())
        except OSError as error:
            raise _lost_scheduler() from error
        if count:
            self._last_seen = time.monotonic()
        elif time.monotonic() - self._last_seen > _PATIENCE:
            raise _no_workers()
        return count


def _without_scheduler() -> contextlib.suppress:
    """Ignore the errors of tidying up after the scheduler was lost."""
    return contextlib.suppress(OSError, RuntimeError, ValueError)


def _lost_scheduler() -> FedicError:
    return FedicError(
        "the scheduler of Dask was lost, or has cancelled the measurement; run again to go on with the frames that are "
        "not finished."
    )


def _no_workers() -> FedicError:
    return FedicError(
        f"the scheduler of Dask has had no workers for {_PATIENCE:.0f} s; start dask worker, and run again to go on "
        "with the frames that are not finished."
    )


def _answers(client: Any, question: Any, *arguments: Any) -> list[Any]:
    """Ask all workers; those that are lost meanwhile do not count."""
    answers = client.run(question, *arguments, on_error="return").values()
    for answer in answers:
        if isinstance(answer, Exception) and not isinstance(answer, OSError):
            raise FedicError(
                f"the workers cannot load fedic {__version__} ({type(answer).__name__}: {answer}); install the same "
                "version everywhere."
            ) from answer
    return [answer for answer in answers if not isinstance(answer, OSError)]


def _sent(client: Any, reference: FrameEntry, image: Image) -> SentReference:
    """Return the reference image as the names of its files if all workers read them, else as the array."""
    checksum = sample_checksum(image)
    files = [file.absolute() for file in entry_files(reference)]
    if len(files) == image_count(reference) and all(_answers(client, is_readable, files, checksum)):
        return SentReference(files, checksum)
    return SentReference(image, checksum)
