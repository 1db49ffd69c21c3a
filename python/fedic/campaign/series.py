"""Measurement of a series of images with all results in one folder."""

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fedic._core import __version__
from fedic._internal.types import Image
from fedic.campaign.campaign import Campaign
from fedic.campaign.cluster import Cluster
from fedic.campaign.config import Config
from fedic.campaign.measured import Measured
from fedic.campaign.outputs import DISPLACEMENT, MESH_PICTURE, RESIDUAL, SUMMARY, Outputs, remove
from fedic.errors import FedicError
from fedic.io.atomic import write_json
from fedic.io.images import read_image
from fedic.plotting import plot_displacement, plot_mesh, plot_residual, save_figure
from fedic.progress import ProgressCallback
from fedic.results import Result, StrainMeasure

__all__ = ["Frame", "measure_series"]

_SUMMARY_SECONDS = 2.0
"""Time between two states of the summary while frames are measured."""


@dataclass(frozen=True)
class Frame:
    """Outcome of one deformed image.

    Attributes
    ----------
    image : Path
        The image file.
    name : str
        Name of its results, the stem of the image unless another has it too.
    seconds : float
        Time that the measurement took.
    outcome : dict
        The summary of the result, or ``{"error": ...}``.
    is_new : bool
        Whether it was measured by this run; otherwise by one that was interrupted.
    """

    image: Path
    name: str
    seconds: float
    outcome: dict[str, Any]
    is_new: bool = True

    @property
    def error(self) -> str | None:
        """The message of the error that stopped this frame, or None."""
        return self.outcome.get("error")

    @property
    def is_good(self) -> bool:
        """Whether the frame was measured and the verdict finds nothing doubtful."""
        return self.error is None and bool(self.outcome["quality"]["good"])


def measure_series(
    config: Config,
    *,
    overwrite: bool = False,
    progress: ProgressCallback | None = None,
    cluster: "Cluster | None" = None,
) -> Iterator[Frame]:
    """Measure every deformed image of a configuration.

    The output folder receives ``results.vtkhdf`` with all frames, for each image the files that ``output.files`` and
    ``output.pictures`` ask for, and ``summary.json``. Frames that an interrupted run has finished are not measured
    again. A frame that fails is recorded, leaves no file of its own, and the others go on. The image files must not
    change meanwhile: large ones are mapped (see `fedic.read_image`).

    Parameters
    ----------
    config : Config
        From `fedic.campaign.load_config`.
    overwrite : bool
        If true, the results of an earlier run in the folder are removed once the reference is prepared.
    progress : callable, optional
        Called with a `fedic.Progress`.
    cluster : str or distributed.Client, optional
        Dask workers that measure the frames; see `fedic.Campaign.run`.

    Yields
    ------
    Frame
        Each frame: first those that were finished before, then each as soon as it is measured and its own files are
        written.

    Raises
    ------
    ConfigError
        If a result would replace a file that is read.
    FedicError
        If the folder cannot be written, holds results of another run and `overwrite` is false; if the reference, the
        mesh, the camera or the workers cannot be used; or, once all frames are done, if some failed or the summary
        could not be written.
    """
    outputs = config.outputs()
    outputs.check()
    outputs.claim(overwrite=overwrite)
    campaign = config.campaign(outputs.results)
    frames: list[Frame] = []
    if not overwrite:
        campaign.check()
        frames = _finished(campaign, config, outputs)
    is_new = not frames
    yield from frames
    unwritten: FedicError | None = None
    written = 0.0
    for measured in campaign.measure(overwrite=overwrite, progress=progress, cluster=cluster):
        if is_new:
            is_new = False
            outputs.clear()
            _write_summary(outputs, config, frames)
            if outputs.pictures:
                reference = read_image(config.images.reference, mapped=True)
                save_figure(plot_mesh(campaign.mesh, campaign.camera, reference), outputs.folder / MESH_PICTURE)
        index = measured.record.index
        path, name = config.images.deformed[index], outputs.names[index]
        frames.append(_completed(measured, path, name, outputs, config.output.strain_measure))
        if time.monotonic() - written > _SUMMARY_SECONDS:
            with contextlib.suppress(FedicError):
                _write_summary(outputs, config, frames)
            written = time.monotonic()
        yield frames[-1]
    try:
        _write_summary(outputs, config, frames)
    except FedicError as error:
        unwritten = error

    failed = [frame for frame in frames if frame.error is not None]
    if failed:
        raise FedicError(
            f"{len(failed)} of {len(frames)} frames failed, the first being {failed[0].image.name}: {failed[0].error} "
            f"The others are in {outputs.folder}."
        )
    if unwritten is not None:
        raise unwritten


def _finished(campaign: Campaign, config: Config, outputs: Outputs) -> list[Frame]:
    """Return the frames that an interrupted run has finished."""
    measure = config.output.strain_measure
    frames = []
    names = zip(config.images.deformed, outputs.names, strict=True)
    for record, (path, name) in zip(campaign.frames, names, strict=False):
        if record.error:
            frames.append(Frame(path, name, record.seconds, {"error": record.error}, is_new=False))
        else:
            outcome = _written(campaign.result(record.index), path, name, outputs, measure)
            frames.append(Frame(path, name, record.seconds, outcome, is_new=False))
    return frames


def _completed(measured: Measured, path: Path, name: str, outputs: Outputs, measure: StrainMeasure) -> Frame:
    """Write the files of a frame that was measured."""
    record, result = measured.record, measured.result
    if result is None:
        return Frame(path, name, record.seconds, {"error": record.error})
    return Frame(path, name, record.seconds, _written(result, path, name, outputs, measure))


def _written(result: Result, path: Path, name: str, outputs: Outputs, measure: StrainMeasure) -> dict[str, Any]:
    """Write those files of a frame that are missing; return its outcome."""
    stem = str(outputs.folder / name)
    try:
        _check_names(path, outputs.of_frame(name))
        for ending in outputs.endings:
            if not Path(stem + ending).exists():
                result.write(stem + ending, measure=measure)
        if outputs.pictures and not Path(stem + RESIDUAL).exists():
            _draw(result, read_image(path, mapped=True), stem)
        outcome = result.summary()
    except (FedicError, OSError, MemoryError) as error:
        outcome = {"error": _sentence(path, error)}
        for file in outputs.of_frame(name):
            with contextlib.suppress(FedicError):
                remove(file)
    return outcome


def _check_names(path: Path, files: list[Path]) -> None:
    """Check, before the measurement, that the file system accepts the names of the results."""
    for file in files:
        try:
            file.lstat()
        except FileNotFoundError:
            continue
        except OSError as error:
            raise FedicError(
                f"{path.name}: the result cannot be called {file.name} ({error.strerror}); rename the image."
            ) from error


def _sentence(path: Path, error: FedicError | OSError | MemoryError) -> str:
    if isinstance(error, FedicError):
        return str(error)
    if isinstance(error, MemoryError):
        return f"{path.name}: there is not enough memory for this frame; give a coarser mesh or smaller images."
    return f"{path.name}: a file cannot be read or written ({error.strerror or error})."


def _draw(result: Result, deformed: Image, stem: str) -> None:
    for component, ending in DISPLACEMENT.items():
        figure = plot_displacement(result, deformed, component)
        save_figure(figure, Path(stem + ending))
    save_figure(plot_residual(result.residual_map()), Path(stem + RESIDUAL))


def _write_summary(outputs: Outputs, config: Config, frames: list[Frame]) -> None:
    entries = [
        {"image": str(frame.image), "name": frame.name, "seconds": round(frame.seconds, 3), **frame.outcome}
        for frame in frames
    ]
    content = {
        "fedic": __version__,
        "settings": config.model_dump(mode="json"),
        "files": [file.name for file in outputs.all()],
        "frames": entries,
    }
    write_json(outputs.folder / SUMMARY, content)
