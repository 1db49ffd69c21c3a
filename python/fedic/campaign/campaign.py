"""A series of frames measured on one mesh, kept in one file."""

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fedic._core import CORRELATION_OPTIONS, STRAIN_MEASURES, ImageFrame, Mesh
from fedic._internal.choices import check_choice
from fedic._internal.masks import pixel_mask
from fedic._internal.types import Camera, StrPath
from fedic._internal.units import checked_unit
from fedic._internal.warning_level import levels_within_fedic
from fedic.campaign.cluster import Cluster
from fedic.campaign.frames import FrameEntry, FrameSeries, Times, load_entry
from fedic.campaign.frames.entry import checked_entry, image_count
from fedic.campaign.measured import Measured
from fedic.campaign.progress_bar import progress_bar
from fedic.campaign.readings import CampaignReadings
from fedic.campaign.record import FrameRecord
from fedic.campaign.run import Run
from fedic.campaign.setup import Setup
from fedic.campaign.store import CampaignFile
from fedic.campaign.tracking import ReferenceUpdate, Starts
from fedic.correlation import Mask
from fedic.errors import FedicError, OptionError, QualityWarning
from fedic.options import core_options, with_options
from fedic.progress import ProgressCallback
from fedic.regularization.equilibrium_gap import Regularization
from fedic.results import StrainMeasure
from fedic.starts.initial import Initial, checked_initial

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from fedic.options import CorrelationOptions

_ARGUMENTS = (
    "store",
    "times",
    "starts",
    "reference_update",
    "strain_measure",
    "initial",
    "mask",
    "regularization",
    "unit",
)

__all__ = ["Campaign", "load"]


@with_options(CORRELATION_OPTIONS)
class Campaign(CampaignReadings):
    """A series of deformed images, measured on one mesh and kept in one file.

    Nothing is measured before `run`. A run that was interrupted, even killed, goes on where it stopped. Frames that
    cannot be read or measured are recorded with the reason; the others are measured.

    Parameters
    ----------
    reference : str, Path, ndarray of shape (height, width), or list of these
        The image of the specimen at rest; of several static images the mean is taken.
    frames : str, Path, sequence or iterable
        The deformed images: a pattern of files such as ``"images/frame_*.tif"``, in the order of their numbers; a
        numbered one such as ``"images/frame_%04d.tif"``, of which missing files are frames that fail; a list of files,
        arrays, or lists of static images of which the mean is taken; a video file; or an iterable of arrays, or of
        pairs of a time and an array.
    mesh : Mesh
        The mesh, in the physical space.
    camera : ImageFrame, FrontParallel or Pinhole
        Projects the mesh to the image.
    store : str or Path, optional
        The file of the results, ``.vtkhdf``; see docs/campaign-files.md. In memory if left out.
    times : {"modified", "recorded"}, float or array_like, optional
        Times of the frames: those of their files, in seconds since 1970 (of the last modification, or as the camera has
        recorded them in the file), the number of frames per second, or one time per frame in seconds.
    starts : {"extrapolated", "previous", "independent"}
        Where a frame starts from: the displacement extrapolated from the last two frames that converged, that of the
        last one, or none. If the result is worse than those of the last two, `initial` is tried too, and the better
        result taken.
    reference_update : {"first", "previous", "auto"}
        Reference image of a frame: the first one; the frame before; or the first one as long as it can be measured
        from, then the last frame that converged. Displacements are always counted from the first mesh. Where both ways
        were measured, their difference is stored as the drift.
    strain_measure : {"green-lagrange", "hencky", "small"}
        Strain measure of the file.
    initial : {"auto", "zero", "pyramid", "fft", "features", "log-polar", "flow"} or array_like of shape (n, 2)
        Start of the first frame, and of those whose own start fails.
    mask, regularization, unit
        See `fedic.Correlator`.
    {options}

    Attributes
    ----------
    mesh : Mesh
        The mesh.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    unit : str
        Unit of length of the mesh; empty if it was not given.

    Raises
    ------
    OptionError
        If an argument is unknown, has the wrong type or lies outside its range.

    Notes
    -----
    With the option ``noise``, the noise of one image as recorded, the noise of means is lower accordingly.

    Examples
    --------
    >>> import fedic
    >>> images = [fedic.synthetic.render(fedic.synthetic.Speckle(4.0), fedic.ImageFrame(), (80, 80),
    ...           displacement=(0.2 * k, 0.0)) for k in range(4)]
    >>> campaign = fedic.Campaign(images[0], images[1:], fedic.rectangle_mesh((16, 16, 64, 64), 12)).run()
    >>> [round(float(campaign[k].displacement[:, 0].mean()), 1) for k in range(len(campaign))]
    [0.2, 0.4, 0.6]
    """

    def __init__(
        self,
        reference: FrameEntry,
        frames: Any,
        mesh: Mesh,
        camera: Camera = ImageFrame(),
        *,
        store: StrPath | None = None,
        times: Times | None = None,
        starts: Starts = "extrapolated",
        reference_update: ReferenceUpdate = "first",
        strain_measure: StrainMeasure = "green-lagrange",
        initial: Initial = "auto",
        mask: Mask | None = None,
        regularization: Regularization = "smooth",
        unit: str | None = None,
        **options: "Unpack[CorrelationOptions]",
    ) -> None:
        for name, value, choices in (
            ("starts", starts, ("extrapolated", "previous", "independent")),
            ("reference_update", reference_update, ("first", "previous", "auto")),
            ("strain_measure", strain_measure, STRAIN_MEASURES),
        ):
            check_choice(name, value, choices)
        core_options(options, CORRELATION_OPTIONS, _ARGUMENTS)
        entry = checked_entry(reference, "reference")
        series = FrameSeries(frames, times)
        setup = Setup(
            mesh,
            camera,
            checked_unit(unit, camera) or None,
            None if mask is None else pixel_mask(mask, load_entry(entry, "reference").shape),
            regularization,
            checked_initial(initial, mesh),
            _with_noise_of_means(options, entry, series, reference_update),
            starts,
            reference_update,
            strain_measure,
        )
        super().__init__(setup, CampaignFile(None if store is None else Path(store)), entry, series)

    def run(
        self,
        *,
        resume: bool = True,
        overwrite: bool = False,
        progress: ProgressCallback | bool | None = None,
        cluster: "Cluster | None" = None,
    ) -> "Campaign":
        """Measure the frames that are not finished yet.

        Parameters
        ----------
        resume : bool
            Whether to go on with the results that `store` holds. They must be of the same reference, mesh and options.
        overwrite : bool
            Whether to replace results that `store` holds, once the reference image is prepared.
        progress : callable or bool, optional
            Called with a `fedic.Progress` after each frame; true for a progress bar, false for none. By default there
            is a bar in a notebook and on a terminal.
        cluster : str or distributed.Client, optional
            Dask workers that measure the frames, see docs/clusters.md: ``"local:4"`` for four processes on this
            machine, the address of a scheduler such as ``"tcp://host:8786"``, or a client.

        Returns
        -------
        Campaign
            This campaign.

        Raises
        ------
        ImageError, MeshError, CameraError, SolveError, OptionError
            If the reference image, the mesh, the camera or the options cannot be used.
        FedicError
            If the results cannot be written, or are of another campaign, or the workers cannot be used.

        Warns
        -----
        QualityWarning
            If frames could not be measured or are doubtful.
        """
        with progress_bar(progress, self._series.count if self._series else None) as callback:
            for _ in self.measure(resume=resume, overwrite=overwrite, progress=callback, cluster=cluster):
                pass
        _warn_of_frames(self.frames)
        return self

    def measure(
        self,
        *,
        resume: bool = True,
        overwrite: bool = False,
        progress: ProgressCallback | None = None,
        cluster: "Cluster | None" = None,
    ) -> Iterator[Measured]:
        """Measure the frames that are not finished yet, one by one.

        Parameters
        ----------
        resume, overwrite
            See `run`.
        progress : callable, optional
            Called with a `fedic.Progress` after each frame.
        cluster : str or distributed.Client, optional
            See `run`.

        Yields
        ------
        Measured
            ``record, result, image`` of each frame as soon as it is measured.

        Raises
        ------
        FedicError
            As `run`.
        """
        yield from self._run().frames(resume=resume, overwrite=overwrite, progress=progress, cluster=cluster)

    def check(self) -> None:
        """Check that results which `store` holds are of this campaign, so that a run can go on with them.

        Raises
        ------
        FedicError
            If they are of another one: the message names what differs.
        """
        self._run().check()

    def __repr__(self) -> str:
        records = self.frames
        doubtful = sum(not record.good for record in records if record.is_measured)
        failed = sum(not record.is_measured for record in records)
        total = self._series.count if self._series else len(records)
        return (
            f"Campaign({len(records)} of {'unknown' if total is None else total} frames finished, {failed} failed, "
            f"{doubtful} doubtful, {self.mesh.num_nodes} nodes, {self._file.name})"
        )

    def _run(self) -> Run:
        if self._series is None or self._reference is None:
            raise FedicError(f"{self._file.name}: a campaign that was loaded has no frames to measure.")
        return Run(self._setup, self._series, self._reference, self._stored())


def load(path: StrPath) -> Campaign:
    """Load the results of a campaign.

    Parameters
    ----------
    path : str or Path
        The file that `Campaign` or ``fedic run`` has written.

    Returns
    -------
    Campaign
        The campaign with its results; it measures no more frames.

    Raises
    ------
    FedicError
        If there is no such file, it is being written, or it is no file of a campaign.
    """
    file = CampaignFile(Path(path))
    campaign = Campaign.__new__(Campaign)
    files = [Path(name) for name in file.text("reference")["files"]]
    CampaignReadings.__init__(campaign, file.setup(), file, files or None, None)
    return campaign


def _with_noise_of_means(
    options: "CorrelationOptions", reference: FrameEntry, series: FrameSeries, update: ReferenceUpdate
) -> dict[str, Any]:
    """Return the options, the noise being the one that both images of a pair have in the mean."""
    given = dict(options)
    noise = given.get("noise")
    counts = {image_count(entry) for entry in series.entries or []} or {1}
    if noise is None or (counts == {1} and image_count(reference) == 1):
        return given
    if len(counts) > 1:
        raise OptionError(
            "frames are means of different numbers of images, so that one noise does not hold for all; leave noise "
            "out, and it is estimated for each frame",
            "noise",
        )
    if update != "first" and counts != {image_count(reference)}:
        raise OptionError(
            "the reference is a mean of another number of images than the frames, which become the reference too "
            f"(reference_update={update!r}), so that one noise does not hold for all; leave noise out, and it is "
            "estimated for each frame",
            "noise",
        )
    if isinstance(noise, float | int):
        given["noise"] = noise * (0.5 / image_count(reference) + 0.5 / counts.pop()) ** 0.5
    return given


def _warn_of_frames(records: list[FrameRecord]) -> None:
    failed = [record for record in records if not record.is_measured]
    doubtful = [record for record in records if record.is_measured and not record.good]
    parts = []
    if failed:
        first = failed[0]
        parts.append(
            f"{len(failed)} of {len(records)} frames could not be measured, the first being {first.name}: {first.error}"
        )
    if doubtful:
        parts.append(
            f"{len(doubtful)} of {len(records)} frames did not converge or are doubtful, the first being "
            f"{doubtful[0].name}; see the quality of their results"
        )
    if parts:
        warnings.warn("; ".join(parts), QualityWarning, stacklevel=levels_within_fedic())
