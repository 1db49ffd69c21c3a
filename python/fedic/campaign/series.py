"""Measurement of a series of images with all results in one folder."""

import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fedic._core import __version__
from fedic._internal.types import Image
from fedic.campaign.config import Config, OutputSection
from fedic.correlation import Correlator
from fedic.errors import ConvergenceWarning, FedicError, QualityWarning
from fedic.io.atomic import make_folder, write_json
from fedic.io.images import image_stem, read_image
from fedic.plotting import plot_displacement, plot_mesh, plot_residual, save_figure
from fedic.progress import ProgressCallback
from fedic.results import Result

__all__ = ["Frame", "measure_series"]


@dataclass(frozen=True)
class Frame:
    """Outcome of one deformed image.

    Attributes
    ----------
    image : Path
        The image file.
    seconds : float
        Time from reading the image to writing the last file.
    outcome : dict
        The summary of the result, or ``{"error": ...}``.
    """

    image: Path
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


def measure_series(config: Config, *, progress: ProgressCallback | None = None) -> Iterator[Frame]:
    """Measure every deformed image of a configuration.

    The output folder receives, for each image, ``<stem>.vtu``, ``<stem>.npz`` and pictures, and ``summary.json``, which
    is written again after each frame. A frame that fails is recorded there and the others go on. The image files must
    not change meanwhile: large ones are mapped (see `fedic.read_image`).

    Parameters
    ----------
    config : Config
        From `fedic.campaign.load_config`.
    progress : callable, optional
        Called with a `fedic.Progress`.

    Yields
    ------
    Frame
        Each frame once its files are written.

    Raises
    ------
    FedicError
        If the reference, the mesh or the camera cannot be used, or, once all frames are done, if some failed.
    """
    folder = make_folder(config.output.folder)
    reference = read_image(config.images.reference, mapped=True)
    mesh = config.mesh.build()
    camera = config.camera.build()
    correlator = Correlator(reference, mesh, camera, **config.correlation.options())
    if config.output.pictures:
        save_figure(plot_mesh(mesh, camera, reference), folder / "mesh.png")

    frames: list[Frame] = []
    for path in config.images.deformed:
        frame = _measure(correlator, path, config.output, progress=progress)
        frames.append(frame)
        _write_summary(folder, config, frames)
        yield frame

    failed = [frame for frame in frames if frame.error is not None]
    if failed:
        raise FedicError(
            f"{len(failed)} of {len(frames)} frames failed, the first being {failed[0].image.name}: {failed[0].error} "
            f"The others are in {folder}."
        )


def _measure(correlator: Correlator, path: Path, output: OutputSection, *, progress: ProgressCallback | None) -> Frame:
    start = time.perf_counter()
    stem = output.folder / image_stem(path)
    try:
        deformed = read_image(path, mapped=True)
        with warnings.catch_warnings():
            # The verdict is part of the outcome.
            warnings.simplefilter("ignore", ConvergenceWarning)
            warnings.simplefilter("ignore", QualityWarning)
            result = correlator.correlate(deformed, progress=progress)
        for suffix in (".vtu", ".npz"):
            result.write(stem.with_name(stem.name + suffix), measure=output.strain_measure)
        if output.pictures:
            _draw(correlator, result, deformed, stem)
        outcome = result.summary()
    except FedicError as error:
        outcome = {"error": str(error)}
    return Frame(path, time.perf_counter() - start, outcome)


def _draw(correlator: Correlator, result: Result, deformed: Image, stem: Path) -> None:
    for component in ("x", "y"):
        figure = plot_displacement(result, deformed, component)
        save_figure(figure, stem.with_name(f"{stem.name}_displacement_{component}.png"))
    residual = correlator.residual_map(deformed, np.nan_to_num(result.unchecked_displacement))
    save_figure(plot_residual(residual), stem.with_name(f"{stem.name}_residual.png"))


def _write_summary(folder: Path, config: Config, frames: list[Frame]) -> None:
    entries = [{"image": str(frame.image), "seconds": round(frame.seconds, 3), **frame.outcome} for frame in frames]
    content = {"fedic": __version__, "settings": config.model_dump(mode="json"), "frames": entries}
    write_json(folder / "summary.json", content)
