"""Measurement of a series of images with all results in one folder."""

import contextlib
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fedic._core import __version__
from fedic._internal.types import Image
from fedic.campaign.config import Config
from fedic.campaign.outputs import DISPLACEMENT, MESH_PICTURE, RESIDUAL, RESULTS, SUMMARY, Outputs, remove
from fedic.correlation import Correlator
from fedic.errors import ConvergenceWarning, FedicError, QualityWarning
from fedic.io.atomic import write_json
from fedic.io.images import read_image
from fedic.plotting import plot_displacement, plot_mesh, plot_residual, save_figure
from fedic.progress import ProgressCallback
from fedic.results import Result, StrainMeasure

__all__ = ["Frame", "measure_series"]


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
        Time from reading the image to writing the last file.
    outcome : dict
        The summary of the result, or ``{"error": ...}``.
    """

    image: Path
    name: str
    seconds: float
    outcome: dict[str, Any]

    @property
    def error(self) -> str | None:
        """The message of the error that stopped this frame, or None."""
        return self.outcome.get("error")

    @property
    def is_good(self) -> bool:
        """Whether the frame was measured and the verdict finds nothing doubtful."""
        return self.error is None and bool(self.outcome["quality"]["good"])


def measure_series(
    config: Config, *, overwrite: bool = False, progress: ProgressCallback | None = None
) -> Iterator[Frame]:
    """Measure every deformed image of a configuration.

    The output folder receives, for each image, ``<stem>.vtu``, ``<stem>.npz`` and pictures, and ``summary.json``, which
    is written again after each frame. A frame that fails is recorded there, leaves no file, and the others go on. The
    image files must not change meanwhile: large ones are mapped (see `fedic.read_image`).

    Parameters
    ----------
    config : Config
        From `fedic.campaign.load_config`.
    overwrite : bool
        If true, the results of an earlier run in the folder are removed once the reference is prepared.
    progress : callable, optional
        Called with a `fedic.Progress`.

    Yields
    ------
    Frame
        Each frame once its files are written.

    Raises
    ------
    ConfigError
        If a result would replace a file that is read.
    FedicError
        If the folder cannot be written, or holds results and `overwrite` is false; if the reference, the mesh or the
        camera cannot be used; or, once all frames are done, if some failed or the summary could not be written.
    """
    outputs = config.outputs()
    outputs.check()
    outputs.claim(overwrite=overwrite)
    reference = read_image(config.images.reference, mapped=True)
    mesh = config.mesh.build()
    camera = config.camera.build()
    correlator = Correlator(reference, mesh, camera, unit=config.mesh.unit, **config.correlation.options())
    outputs.clear()
    frames: list[Frame] = []
    _write_summary(outputs, config, frames)
    if outputs.pictures:
        save_figure(plot_mesh(mesh, camera, reference), outputs.folder / MESH_PICTURE)

    unwritten: FedicError | None = None
    for path, name in zip(config.images.deformed, outputs.names, strict=True):
        frames.append(_measure(correlator, path, name, outputs, config.output.strain_measure, progress=progress))
        try:
            _write_summary(outputs, config, frames)
            unwritten = None
        except FedicError as error:
            unwritten = error
        yield frames[-1]

    failed = [frame for frame in frames if frame.error is not None]
    if failed:
        raise FedicError(
            f"{len(failed)} of {len(frames)} frames failed, the first being {failed[0].image.name}: {failed[0].error} "
            f"The others are in {outputs.folder}."
        )
    if unwritten is not None:
        raise unwritten


def _measure(
    correlator: Correlator,
    path: Path,
    name: str,
    outputs: Outputs,
    measure: StrainMeasure,
    *,
    progress: ProgressCallback | None,
) -> Frame:
    start = time.perf_counter()
    stem = str(outputs.folder / name)
    try:
        _check_names(path, outputs.of_frame(name))
        deformed = read_image(path, mapped=True)
        with warnings.catch_warnings():
            # The verdict is part of the outcome.
            warnings.simplefilter("ignore", ConvergenceWarning)
            warnings.simplefilter("ignore", QualityWarning)
            result = correlator.correlate(deformed, progress=progress)
        for ending in RESULTS:
            result.write(stem + ending, measure=measure)
        if outputs.pictures:
            _draw(correlator, result, deformed, stem)
        outcome = result.summary()
    except (FedicError, OSError, MemoryError) as error:
        outcome = {"error": _sentence(path, error)}
        for file in outputs.of_frame(name):
            with contextlib.suppress(FedicError):
                remove(file)
    return Frame(path, name, time.perf_counter() - start, outcome)


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


def _draw(correlator: Correlator, result: Result, deformed: Image, stem: str) -> None:
    for component, ending in DISPLACEMENT.items():
        figure = plot_displacement(result, deformed, component)
        save_figure(figure, Path(stem + ending))
    residual = correlator.residual_map(deformed, np.nan_to_num(result.unchecked_displacement))
    save_figure(plot_residual(residual), Path(stem + RESIDUAL))


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
