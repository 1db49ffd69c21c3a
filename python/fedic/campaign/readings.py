"""What is read from the results of a campaign."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from fedic._core import Mesh
from fedic._internal.types import Camera, Floats, StrPath
from fedic.campaign.frames import FrameEntry, FrameSeries, load_entry
from fedic.campaign.frames.entry import entry_files
from fedic.campaign.record import FrameRecord
from fedic.campaign.results import StoredResults, records_of
from fedic.campaign.setup import Setup
from fedic.campaign.store import CampaignFile
from fedic.results import Covariance, Result, StrainAxes, StrainMeasure

if TYPE_CHECKING:
    import pandas as pd

    from fedic.probes import At

__all__ = ["CampaignReadings"]


class CampaignReadings:
    """The results of a campaign, read frame by frame from its file or from memory."""

    def __init__(
        self, setup: Setup, file: CampaignFile, reference: FrameEntry | None, series: FrameSeries | None
    ) -> None:
        self._setup, self._file, self._reference, self._series = setup, file, reference, series
        self._results: StoredResults | None = None

    @property
    def mesh(self) -> Mesh:
        """The mesh."""
        return self._setup.mesh

    @property
    def camera(self) -> Camera:
        """The camera."""
        return self._setup.camera

    @property
    def unit(self) -> str:
        """Unit of length of the mesh; empty if it was not given."""
        return self._setup.unit or ""

    @property
    def path(self) -> Path | None:
        """The file of the results; None if they are in memory."""
        return self._file.path

    @property
    def frames(self) -> list[FrameRecord]:
        """What is known of each finished frame, those that failed too."""
        return records_of(self._file) if self._file.exists else []

    def __len__(self) -> int:
        """Return the number of finished frames."""
        return self._file.num_frames() if self._file.exists else 0

    @overload
    def __getitem__(self, index: int) -> Result: ...

    @overload
    def __getitem__(self, index: slice) -> list[Result]: ...

    def __getitem__(self, index: int | slice) -> Result | list[Result]:
        """Return the result of a frame, or of several; as `result`."""
        numbers = range(len(self))
        if isinstance(index, slice):
            return [self.result(number) for number in numbers[index]]
        try:
            return self.result(numbers[index])
        except IndexError:
            raise IndexError(f"there is no frame {index}; {len(numbers)} frames are finished") from None

    def __iter__(self) -> Iterator[Result]:
        """Yield the results of the frames that were measured."""
        for record in self.frames:
            if record.is_measured:
                yield self.result(record.index)

    def result(self, index: int) -> Result:
        """Return the result of a frame.

        Parameters
        ----------
        index : int
            Its number, from 0.

        Returns
        -------
        Result
            The result. Fields other than the displacement have single precision.

        Raises
        ------
        FedicError
            If the frame was not measured; the message says why.
        """
        return self._stored().result(index)

    def covariance(self, index: int) -> Covariance | None:
        """Return the covariance of the displacement of a frame; see `Result.covariance`.

        Parameters
        ----------
        index : int
            Its number, from 0.

        Returns
        -------
        Covariance or None
            None if the noise is not known, or an image is not any more.
        """
        return self._stored().covariance(index)

    def drift(self, index: int) -> Floats | None:
        """Return the difference of two ways to measure a frame.

        Parameters
        ----------
        index : int
            Its number, from 0.

        Returns
        -------
        ndarray of float, shape (n, 2), or None
            Displacement through later reference images minus the direct one, in the mesh's unit; NaN if only one was
            measured. None if the reference image is never updated.
        """
        drift = self._file.frame(index).fields.get("PointData/drift")
        return None if drift is None else np.asarray(drift[:, :2], dtype=np.float64)

    def table(
        self,
        fields: str | Sequence[str],
        at: "At" = None,
        measure: StrainMeasure | None = None,
        axes: StrainAxes | None = None,
        centre: ArrayLike | None = None,
    ) -> "pd.DataFrame":
        """Read fields of all frames at some places; see `fedic.probes.table`, and docs/probes.md.

        Parameters
        ----------
        fields, at, measure, axes, centre
            As for `fedic.probes.table`; the measure is `strain_measure` by default.

        Returns
        -------
        pandas.DataFrame
            One row a frame, a column a field and place: ``eyy``, ``eyy_std``.
        """
        from fedic.probes import table

        return table(self, fields, at, measure or self._setup.strain_measure, axes, centre)

    def frame_table(self) -> "pd.DataFrame":
        """Return what is known of each frame, with its rigid motion; see `fedic.probes.frame_table`."""
        from fedic.probes import frame_table

        return frame_table(self)

    def join(self, source: "StrPath | pd.DataFrame", *, time: str, **options: Any) -> "pd.DataFrame":
        """Interpolate the channels of a testing machine at the times of the frames; see `fedic.probes.join`.

        Parameters
        ----------
        source : str, Path or pandas.DataFrame
            The record of the machine.
        time : str
            Column of the machine's clock.
        **options
            ``offset``, ``correlate``, ``columns``, ``units``, ``gap`` of `fedic.probes.join`.

        Returns
        -------
        pandas.DataFrame
            One row a frame, a column a channel.
        """
        from fedic.probes import join

        return join(self, source, time=time, **options)

    def export(
        self, path: StrPath, *, what: Literal["nodes", "cells"] = "nodes", measure: StrainMeasure | None = None
    ) -> Path:
        """Write all frames as ``.csv``, ``.parquet``, ``.xlsx``, ``.pvd``, ``.npz`` or ``.mat``; see docs/probes.md.

        Parameters
        ----------
        path : str or Path
            The file; its suffix chooses the format.
        what : {"nodes", "cells"}
            Rows of the tables.
        measure : {"green-lagrange", "hencky", "small"}, optional
            Strain measure; `strain_measure` by default.

        Returns
        -------
        Path
            The file written.
        """
        from fedic.io.exports import export

        return export(self, path, what=what, measure=measure or self._setup.strain_measure)

    def _stored(self) -> StoredResults:
        if self._results is None:
            array = self._reference
            image = None if array is None or entry_files(array) else load_entry(array, "reference")
            self._results = StoredResults(self._file, self._setup, image, (self._series and self._series.entries) or [])
        return self._results
