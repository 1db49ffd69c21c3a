"""The run of a campaign: which frames are left, and how they are written and reported once they are measured."""

from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any

from fedic._core import __version__
from fedic._internal.types import Image
from fedic.campaign.cluster import Cluster, check_cluster, cluster_executor
from fedic.campaign.frames import FrameEntry, FrameSeries, load_entry
from fedic.campaign.frames.entry import entry_files
from fedic.campaign.frames.series import SeriesFrame
from fedic.campaign.measured import Executor, Measured
from fedic.campaign.results import StoredResults, records_of
from fedic.campaign.serial import SerialExecutor
from fedic.campaign.setup import Setup, setup_entries
from fedic.campaign.store import WriteBehind
from fedic.campaign.tracking import Tracked, is_known
from fedic.correlation import Correlator
from fedic.errors import FedicError, OptionError
from fedic.io.image_origins import sample_checksum
from fedic.progress import Progress, ProgressCallback
from fedic.results import Result

__all__ = ["Run", "reference_entries"]


@dataclass(frozen=True, eq=False)
class Run:
    """What a run measures, and where it writes.

    Attributes
    ----------
    setup : Setup
        What is measured with.
    series : FrameSeries
        The frames.
    reference : FrameEntry
        The reference image.
    results : StoredResults
        The results and their file.
    """

    setup: Setup
    series: FrameSeries
    reference: FrameEntry
    results: StoredResults

    def frames(
        self,
        *,
        resume: bool,
        overwrite: bool,
        progress: ProgressCallback | None = None,
        cluster: "Cluster | None" = None,
    ) -> Iterator[Measured]:
        """Measure the frames that are not finished.

        Parameters
        ----------
        resume : bool
            Whether to go on with a file that holds frames.
        overwrite : bool
            Whether to replace a file that exists, once the reference image is prepared.
        progress : callable, optional
            Called with a `fedic.Progress` after each frame.
        cluster : str or distributed.Client, optional
            The workers that measure; this process by default.

        Yields
        ------
        Measured
            Each frame, before it is written.

        Raises
        ------
        FedicError
            If the file cannot be used, or the reference image, the mesh, the camera or the workers.
        """
        if cluster is not None:
            self._check_cluster(cluster)
        file, count = self.results.file, self.series.count
        is_there = file.exists and not overwrite
        if is_there and not resume:
            raise FedicError(
                f"{file.name}: there are results already; resume them (resume=True), replace them (overwrite=True), or "
                "write to another file."
            )
        image = load_entry(self.reference, "reference")
        if is_there:
            file.open()
        try:
            done = self._checked_frames(image) if is_there else 0
            if is_there and done == count:
                return
            correlator = self.setup.prepare(image, self.setup.mesh, self.setup.mask, progress)
            self.results.keep(correlator)
            with self._executor(correlator, image, cluster) as executor:
                if not is_there:
                    file.create(self.setup, reference_entries(self.reference, image), count, overwrite=overwrite)
                elif count is not None and count > file.capacity():
                    file.resize(count)
                yield from self._measured(executor, done, progress)
            if count is None:
                file.resize(file.num_frames())
        finally:
            file.close()

    def check(self) -> None:
        """Check that the frames of the file, if there are any, belong to this campaign.

        Raises
        ------
        FedicError
            If they do not.
        """
        if self.results.file.exists:
            self._checked_frames(load_entry(self.reference, "reference"))

    def _check_cluster(self, cluster: Cluster) -> None:
        check_cluster(cluster)
        if self.setup.reference_update != "first":
            raise OptionError(
                f"reference_update={self.setup.reference_update!r} needs the frame before, which another worker of "
                "Dask may have; give 'first', or measure without Dask",
                "reference_update",
            )

    def _executor(
        self, correlator: Correlator, image: Image, cluster: "Cluster | None"
    ) -> AbstractContextManager[Executor]:
        if cluster is None:
            return nullcontext(SerialExecutor(self.setup, correlator))
        return cluster_executor(cluster, self.setup, self.reference, image, self.results)

    def _measured(self, executor: Executor, done: int, progress: ProgressCallback | None) -> Iterator[Measured]:
        writer = WriteBehind(self.results.file)
        try:
            for finished in executor.measure(self._remaining(executor, done)):
                measured = finished.measured
                writer.put(finished.data, measured.record.seconds)
                if progress is not None:
                    progress(_progress(measured, self.series.count))
                yield measured
        finally:
            writer.close()

    def _remaining(self, executor: Executor, done: int) -> Iterator[SeriesFrame]:
        """Yield the frames that are not finished, once the executor has those that it goes on from."""
        if done == 0:
            yield from iter(self.series)
            return
        known, reference = self._last_known(done)
        wanted = {each.index for each in known} | ({reference.index} if reference else set())
        images: dict[int, Image] = {}
        needs_images = self.setup.reference_update != "first"
        if self.series.count is not None:
            if needs_images:
                images = {index: load_entry(self.series.frame(index).entry, "reference") for index in wanted}
            executor.restore(_with_images(known, images), _with_image(reference, images))
            yield from map(self.series.frame, range(done, self.series.count))
            return
        for frame in self.series:
            if frame.index in wanted and needs_images:
                images[frame.index] = load_entry(frame.entry, "reference")
            if frame.index == done:
                executor.restore(_with_images(known, images), _with_image(reference, images))
            if frame.index >= done:
                yield frame

    def _last_known(self, done: int) -> tuple[list["_Earlier"], "_Earlier | None"]:
        """Return the last two frames that later ones may start from, and the last reference image."""
        records = records_of(self.results.file)
        known: list[_Earlier] = []
        for index in range(done - 1, -1, -1):
            if len(known) == 2:
                break
            if records[index].is_measured and records[index].converged:
                result = self.results.result(index)
                if is_known(result):
                    known.insert(0, _Earlier(index, result, records[index].reference))
        measured = [record for record in records if record.is_measured]
        last = measured[-1].reference if measured else -1
        reference = None if last < 0 else _Earlier(last, self.results.result(last), records[last].reference)
        return known, reference

    def _checked_frames(self, image: Image) -> int:
        """Check that the file belongs to this campaign; return the number of its frames."""
        file = self.results.file
        expected = {
            **setup_entries(self.setup),
            "reference image": reference_entries(self.reference, image)["checksum"],
        }
        found = {**file.text("settings"), "reference image": file.text("reference")["checksum"]}
        names = sorted(name for name in expected | found if expected.get(name) != found.get(name))
        if names:
            raise FedicError(
                f"{file.name}: these results are of another campaign: {', '.join(_differing(names, expected, found))} "
                "differ. Write to another file, or replace them (--overwrite, overwrite=True)."
            )
        writer = file.text("versions")["fedic"]
        done = file.num_frames()
        count = self.series.count
        if count is not None and done != count and writer != __version__:
            raise FedicError(
                f"{file.name}: these results are of fedic {writer}, this is {__version__}, which may measure other "
                "bits; end them with that version, or replace them (--overwrite, overwrite=True)."
            )
        if count is None:
            return done
        stored = [record.name for record in records_of(file)]
        given = [self.series.frame(index).name for index in range(min(done, count))]
        different = [index for index, name in enumerate(given) if name != stored[index]]
        if different or done > count:
            where = different[0] if different else count
            other = given[where] if different else "missing"
            raise FedicError(
                f"{file.name}: these results are of other frames: number {where} is {stored[where]} there, and {other} "
                "among the frames given. Write to another file, or replace them (--overwrite, overwrite=True)."
            )
        return done


@dataclass(frozen=True, eq=False)
class _Earlier:
    index: int
    result: Result
    reference: int


def reference_entries(reference: FrameEntry, image: Image) -> dict[str, Any]:
    """Return JSON types that identify a reference image."""
    return {
        "files": [str(file.absolute()) for file in entry_files(reference)],
        "shape": list(image.shape),
        "checksum": sample_checksum(image),
    }


def _progress(measured: Measured, count: int | None) -> Progress:
    record, result = measured.record, measured.result
    done = record.index + 1
    return Progress(
        f"frame {record.name}",
        None if count is None else done / count,
        residual_rms=record.residual_rms,
        frame=done,
        frames=count,
        flagged_cells=0 if result is None else int((result.quality.cell_flags != 0).sum()),
    )


def _with_image(earlier: _Earlier | None, images: Mapping[int, Image]) -> Tracked | None:
    if earlier is None:
        return None
    image: Any = images.get(earlier.index)
    return Tracked(earlier.index, image, earlier.result, earlier.reference)


def _with_images(known: list[_Earlier], images: Mapping[int, Image]) -> list[Tracked]:
    return [tracked for earlier in known if (tracked := _with_image(earlier, images)) is not None]


def _differing(names: list[str], expected: Mapping[str, Any], found: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names of the settings that differ; of the options those alone that do."""
    for name in names:
        if name != "options":
            yield name
            continue
        given, stored = expected["options"], found["options"]
        yield from sorted(key for key in given | stored if given.get(key) != stored.get(key))
