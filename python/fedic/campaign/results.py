"""Results read from the file of a campaign."""

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic import _core
from fedic._core import CORRELATION_OPTIONS, Mesh
from fedic._internal.measurement import Measurement
from fedic._internal.types import Floats, Image
from fedic._internal.units import checked_unit
from fedic.campaign.frames import FrameEntry, load_entry
from fedic.campaign.record import FrameRecord
from fedic.campaign.setup import Setup
from fedic.campaign.store import CampaignFile, FrameData, to_result
from fedic.campaign.tracking.prediction import filled
from fedic.campaign.tracking.reference import moved_mask, moved_mesh
from fedic.correlation import Correlator
from fedic.errors import FedicError
from fedic.io.kept import KeptImage
from fedic.options import core_options
from fedic.results import Covariance, Result

__all__ = ["StoredResults", "records_of"]

_RECORD_COLUMNS = tuple(each.name for each in dataclasses.fields(FrameRecord) if each.name != "index")


@dataclass(frozen=True, eq=False)
class _Place:
    """A reference image, and where the mesh lies in it."""

    image: KeptImage
    mesh: Mesh
    mask: NDArray[np.bool_] | None
    displacement: Floats | None


@dataclass(eq=False)
class StoredResults:
    """Results of a campaign, made of what its file holds.

    Attributes
    ----------
    file : CampaignFile
        The file.
    setup : Setup
        What was measured with.
    reference : ndarray of shape (height, width), or None
        The first reference image, if it has no file.
    entries : sequence of FrameEntry
        The frames, for those that have no file; empty if they are not known.
    """

    file: CampaignFile
    setup: Setup
    reference: Image | None
    entries: Sequence[FrameEntry]
    _places: dict[int, _Place] = field(default_factory=dict)
    _correlators: dict[int, Correlator] = field(default_factory=dict)

    def result(self, index: int) -> Result:
        """Return the result of a frame.

        Parameters
        ----------
        index : int
            Its number.

        Returns
        -------
        Result
            The result.

        Raises
        ------
        FedicError
            If the frame could not be measured; the message is that of the frame.
        """
        data = self.file.frame(index)
        if data.columns["error"]:
            name, error = (data.columns[key].decode() for key in ("name", "error"))
            raise FedicError(f"frame {index} ({name}) was not measured: {error}")
        return self.result_of(data, None)

    def result_of(self, data: FrameData, image: Image | None) -> Result:
        """Return the result of a frame that was measured.

        Parameters
        ----------
        data : FrameData
            What is stored of it.
        image : ndarray of shape (height, width), or None
            Its image, if it has no file and is known.

        Returns
        -------
        Result
            The result.
        """
        setup = self.setup
        unit = checked_unit(setup.unit, setup.camera)
        return to_result(setup.mesh, setup.camera, unit, data, self._measurement(data, image))

    def covariance(self, index: int) -> Covariance | None:
        """Return the covariance of a frame; None if the noise is not known, or an image is not any more."""
        return self.result(index)._covariance

    def keep(self, correlator: Correlator) -> None:
        """Use the correlator of the first reference image that a run has prepared."""
        self._correlators[-1] = correlator

    def _measurement(self, data: FrameData, image: Image | None) -> Measurement:
        reference = int(data.columns["reference"])
        place = self._place(reference)
        setup = self.setup
        return Measurement(
            reference=place.image,
            deformed=self._kept_frame(data, "deformed", image),
            mesh=place.mesh,
            camera=setup.camera,
            mask=place.mask,
            regularization=setup.regularization,
            options=core_options(setup.options, CORRELATION_OPTIONS),
            correlator=self._prepared(reference),
            first=None if place.displacement is None else (setup.mesh, place.displacement),
            has_lost_weights=bool(data.columns["has_weights"]),
        )

    def _place(self, reference: int) -> _Place:
        setup = self.setup
        if reference < 0:
            entries = self.file.text("reference")
            files = [Path(file) for file in entries["files"]]
            image = _kept("reference", files, None if files else self.reference, entries["checksum"])
            return _Place(image, setup.mesh, setup.mask, None)
        if reference not in self._places:
            data = self.file.frame(reference)
            displacement = filled(setup.mesh, np.asarray(data.fields["PointData/displacement"])[:, :2])
            mesh = moved_mesh(setup.mesh, displacement)
            mask = moved_mask(setup.mask, setup.mesh, displacement, mesh, setup.camera)
            self._places = {reference: _Place(self._kept_frame(data, "reference", None), mesh, mask, displacement)}
        return self._places[reference]

    def _kept_frame(self, data: FrameData, name: str, image: Image | None) -> KeptImage:
        names = data.columns["image"].decode("utf-8", "surrogateescape")
        files = [Path(file) for file in names.split("\n") if file]
        if image is None and self.entries and not files:
            image = load_entry(self.entries[data.index], name)
        return _kept(name, files, None if files else image, int(data.columns["checksum"]))

    def _prepared(self, reference: int) -> Callable[[], "_core.Correlator"]:
        """Return a function that prepares a reference image when it is first needed."""

        def prepare() -> "_core.Correlator":
            if reference not in self._correlators:
                place = self._place(reference)
                correlator = self.setup.prepare(place.image.read(), place.mesh, place.mask)
                # The first reference image and one later one.
                kept = {-1: self._correlators[-1]} if -1 in self._correlators else {}
                self._correlators = kept | {reference: correlator}
            return self._correlators[reference]._core

        return prepare


def records_of(file: CampaignFile) -> list[FrameRecord]:
    """Return the records of all frames of a file."""
    columns = file.columns(_RECORD_COLUMNS)
    rows = zip(*(columns[name].tolist() for name in _RECORD_COLUMNS), strict=True)
    return [FrameRecord(index, **_values(row)) for index, row in enumerate(rows)]


def _values(row: tuple[Any, ...]) -> dict[str, Any]:
    values = dict(zip(_RECORD_COLUMNS, row, strict=True))
    for name in ("name", "error", "start"):
        values[name] = values[name].decode()
    for name in ("converged", "good"):
        values[name] = bool(values[name])
    return values


def _kept(name: str, files: list[Path], array: Image | None, checksum: int) -> KeptImage:
    return KeptImage(name, files[0] if files else None, array, checksum, tuple(files[1:]))
