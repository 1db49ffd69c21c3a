"""The measurement: from two images, a mesh and a camera to a displacement field."""

import warnings
import weakref
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic import _core
from fedic._core import CORRELATION_OPTIONS, ImageFrame, Mesh
from fedic._internal.masks import pixel_mask
from fedic._internal.measurement import Measurement
from fedic._internal.mesh_faults import warn_of_mesh_faults
from fedic._internal.mesh_size import with_size
from fedic._internal.types import Camera, Floats, Image
from fedic._internal.units import checked_unit
from fedic._internal.warning_level import levels_within_fedic
from fedic.cameras.image_size import check_image_size
from fedic.errors import CalibrationWarning, MeshError, QualityWarning, SolveError
from fedic.io.image_origins import file_of
from fedic.io.images import copy_if_writable, release_pages, validate_deformed
from fedic.io.kept import KeptImage
from fedic.options import core_options, with_options
from fedic.progress import ProgressCallback, core_callback
from fedic.regularization.equilibrium_gap import Regularization, core_gap
from fedic.results import Attempt, Covariance, Iteration, Result
from fedic.results.verdict import quality_of, warn_of_quality
from fedic.starts.autocorrelation import may_repeat
from fedic.starts.automatic import measure_from_any_start
from fedic.starts.initial import Initial, Start, checked_initial
from fedic.starts.threads import opencv_threads

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from fedic.options import CorrelationOptions

__all__ = ["Correlator", "Mask", "correlate"]

Mask: TypeAlias = ArrayLike | Sequence[ArrayLike]

_OTHER_ARGUMENTS = ("initial", "mask", "regularization", "unit", "progress")


@with_options(CORRELATION_OPTIONS)
class Correlator:
    """A reference image, a mesh and a camera prepared once, to measure many deformed images.

    Parameters
    ----------
    reference : ndarray of uint8, uint16 or float32, shape (height, width)
        The image of the specimen at rest. It is copied, as the buffer of a camera may be filled again; a read-only
        array, such as that of ``read_image(path, mapped=True)``, is kept as it is.
    mesh : Mesh
        The mesh, in the physical space.
    camera : ImageFrame, FrontParallel or Pinhole
        Projects the mesh to the image. `ImageFrame` is for a mesh drawn in pixels.
    initial : {"auto", "zero", "pyramid", "fft", "features", "log-polar", "flow"}, Result or array_like of shape (n, 2)
        Initial displacement. ``"auto"``, the default, tries ``"zero"`` and then the others in this order, until the
        verdict accepts the result of one; see docs/starts.md. ``"zero"``: none; ``"pyramid"``: that found on reduced
        images, coarse to fine; ``"fft"``: a whole-pixel translation found by cross-correlation over the whole image;
        ``"features"``: a motion of the whole mesh from matched key points, ``"log-polar"``: one with any rotation or
        scale; ``"flow"``: dense optical flow. Or nodal displacements in the mesh's unit, or the result of an earlier
        frame on the same mesh. On a mesh of a thousand cells or more, all but ``"pyramid"`` are improved by a smooth
        field fitted to a few hundred cells, if that lowers their residual.
    mask : array_like of shape (height, width), or list of polygons, optional
        Pixels of the reference image that are left out: where an image is true or not zero, or inside polygons of shape
        (k, 2), their corners ``(u, v)`` in pixels. Points within twice the smoothing of such a pixel carry no weight.
    regularization : {"smooth"} or EquilibriumGap
        What `regularization_length` is the length of: ``"smooth"``, a penalty on the second derivatives of the
        displacement, or `EquilibriumGap`, one on the forces of linear elasticity where no load acts. See
        docs/regularization.md.
    unit : str, optional
        Unit of length of the mesh, such as ``"mm"``, for the labels of pictures and for files; ``"px"`` for a mesh
        drawn in pixels.
    progress : callable, optional
        Called with a `fedic.Progress` once the reference is prepared.
    {options}

    Raises
    ------
    OptionError
        If an option is unknown, has the wrong type or lies outside its range.
    ImageError
        If the reference image cannot be used.
    MeshError
        If the mesh has inverted cells or does not project into the image.
    CameraError
        If the camera is that of images of another size.
    SolveError
        If the image does not determine the displacement of some node.
    """

    def __init__(
        self,
        reference: Image,
        mesh: Mesh,
        camera: Camera = ImageFrame(),
        *,
        initial: Initial = "auto",
        mask: Mask | None = None,
        regularization: Regularization = "smooth",
        unit: str | None = None,
        progress: ProgressCallback | None = None,
        **options: "Unpack[CorrelationOptions]",
    ) -> None:
        arguments = core_options(options, CORRELATION_OPTIONS, _OTHER_ARGUMENTS)
        self._unit = checked_unit(unit, camera)
        self._reference = copy_if_writable(reference, "reference")
        self._mesh = mesh
        self._camera = camera
        self._initial = checked_initial(initial, mesh)
        check_image_size(camera, self._reference.shape, "reference")
        self._mask = pixel_mask(mask, self._reference.shape)
        self._regularization = regularization
        gap = core_gap(regularization, mesh)
        try:
            self._core = _core.Correlator(
                self._reference, mesh, camera, mask=self._mask, gap=gap, progress=core_callback(progress), **arguments
            )
        except (MeshError, SolveError) as error:
            error.message = with_size(error.message, mesh, camera, self._reference.shape)
            raise
        self._options = arguments
        self._given_options = options
        self._kept_reference = KeptImage.of(self._reference, "reference", path=file_of(reference))
        release_pages(self._reference)
        _warn_of_extrapolation(camera, mesh, mesh.points, "of the mesh lie")
        warn_of_mesh_faults(mesh)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what the correlator was made of: it is prepared anew where it is loaded."""
        named = {
            "initial": self._initial,
            "mask": self._mask,
            "regularization": self._regularization,
            "unit": self._unit or None,
            **self._given_options,
        }
        return _prepared_again, (type(self), (self._reference, self._mesh, self._camera), named)

    @property
    def num_points(self) -> int:
        """Number of quadrature points."""
        return self._core.num_points

    def correlate(
        self,
        deformed: Image,
        initial: Initial | None = None,
        progress: ProgressCallback | None = None,
        *,
        pyramid: bool = False,
    ) -> Result:
        """Measure the displacement between the reference and one deformed image.

        Parameters
        ----------
        deformed : ndarray of uint8, uint16 or float32, shape (height, width)
            The image of the deformed specimen.
        initial : str, Result or array_like of shape (n, 2), optional
            Initial displacement of this frame, as for the constructor; by default the one given there. No earlier frame
            is remembered: give its result.
        progress : callable, optional
            Called with a `fedic.Progress` after each iteration.
        pyramid : bool
            Begin on reduced images if the initial displacement is a result or an array: it may be some pixels off.

        Returns
        -------
        Result
            The displacement, how it was reached, and the verdict on it.

        Raises
        ------
        ImageError
            If the deformed image cannot be used or differs in size from the reference image.
        OptionError
            If the initial displacement is unknown or does not fit the mesh.
        SolveError
            If the images do not determine the displacement of some node, or the iterations diverge from every start.

        Warns
        -----
        ConvergenceWarning
            If the iterations did not converge.
        QualityWarning
            If the verdict on the result is that something is doubtful, or many pixels are saturated.
        """
        original, deformed = deformed, validate_deformed(self._reference, deformed)
        start = self._initial if initial is None else checked_initial(initial, self._mesh)
        with opencv_threads(self._options.get("num_threads")):
            solution, name, attempts = self._solution(deformed, start, pyramid, core_callback(progress))
            images = (self._reference, deformed)
            quality = quality_of(self._core, solution, images, self._mesh, self._repeats)
        places = self._mesh.points.copy()
        places[:, :2] += np.nan_to_num(solution.displacement)
        _warn_of_extrapolation(self._camera, self._mesh, places, "have moved")
        result = Result(
            mesh=self._mesh,
            camera=self._camera,
            displacement=solution.displacement,
            pixel_displacement=solution.pixel_displacement,
            converged=solution.converged,
            error_left=solution.error_left,
            iterations=solution.iterations,
            history=[Iteration(*entry) for entry in solution.history],
            num_points=solution.num_points,
            residual_rms=solution.residual_rms,
            cell_residuals=solution.cell_residuals,
            outside_cells=solution.outside_cells,
            unchecked_displacement=solution.unchecked_displacement,
            quality=quality,
            information=solution.information,
            start=name,
            attempts=tuple(attempts),
            unit=self._unit,
            _measurement=Measurement(
                reference=self._kept_reference,
                deformed=KeptImage.of(original, "deformed", path=file_of(original)),
                mesh=self._mesh,
                camera=self._camera,
                mask=self._mask,
                regularization=self._regularization,
                options=self._options,
                correlator=weakref.ref(self._core),
            ),
        )
        warn_of_quality(result)
        return result

    def _solution(
        self, deformed: Image, start: Start | Floats, pyramid: bool, progress: Any
    ) -> tuple["_core.Solution", str, list[Attempt]]:
        """Return the solution from a start, the name of the start and the attempts of ``"auto"``."""
        images = (self._reference, deformed)
        if isinstance(start, np.ndarray):
            solution = self._core.correlate(deformed, initial=start, pyramid=pyramid, progress=progress)
            return solution, "given+pyramid" if pyramid else "given", []
        if start == "auto":
            solution, attempts = measure_from_any_start(self._core, images, self._mesh, self._camera, progress)
            return solution, attempts[-1].start, attempts
        field = None
        if start == "fft":
            from fedic.starts.fft import initial_translation

            field = initial_translation(*images, self._mesh, self._camera)
        elif start not in ("zero", "pyramid"):
            field = _estimated(start, images, self._mesh, self._camera)
        solution = self._core.correlate(deformed, initial=field, pyramid=start == "pyramid", progress=progress)
        return solution, start, []

    @cached_property
    def _repeats(self) -> Floats:
        """Translations at which the texture of the reference image resembles itself."""
        if not may_repeat(self._reference, self._core.node_pixels()[self._mesh.used_nodes]):
            return np.empty((0, 2))
        from fedic.starts.images import StartImages
        from fedic.starts.periodicity import repeats

        return repeats(StartImages.of(self._reference, self._reference, self._mesh, self._camera))

    def residual_map(self, deformed: Image, displacement: ArrayLike) -> NDArray[np.float32]:
        """Map the grey-level residual over the reference image.

        Parameters
        ----------
        deformed : ndarray, shape (height, width)
            The image of the deformed specimen.
        displacement : array_like, shape (n, 2)
            Nodal displacements in the mesh's unit.

        Returns
        -------
        ndarray of float32, shape (height, width)
            ``f - g`` of the images as smoothed, after the brightness correction, in grey levels; NaN at pixels whose
            centre lies outside the mesh or is masked.
        """
        return self._core.residual_map(validate_deformed(self._reference, deformed), displacement)

    def standard_deviations(self, noise: float, displacement: ArrayLike | None = None) -> Floats:
        """Predict the standard deviation of the displacement from the noise of the images.

        Parameters
        ----------
        noise : float
            Standard deviation, in grey levels, of the noise of one image as recorded, before any smoothing.
        displacement : array_like, shape (n, 2), optional
            Nodal displacements in the mesh's unit near which they are predicted; none by default.

        Returns
        -------
        ndarray of float64, shape (n, 2)
            Standard deviation of each node's displacement, in the mesh's unit; NaN at nodes that no cell uses or all of
            whose points are masked.

        Raises
        ------
        OptionError
            If the noise is negative or not finite.

        Notes
        -----
        The noise is taken as white from pixel to pixel and the same in both images. The covariance of the displacement
        is then

            2 noise^2 A^-1 B A^-1,   A = sum w q q^T,   B = sum (w^2 / p) h h^T

        over the quadrature points: ``w`` their weights, ``p`` the pixels each stands for, ``q`` the shape functions
        times the gradient of the reference image in the mesh's frame, ``h`` the same of the image filtered once more
        (``q`` itself without a smoothing); ``A`` includes the regularization. With one point per pixel, as many pixels
        per area everywhere and neither smoothing nor regularization this is the Cramer-Rao bound
        ``2 noise^2 (sum q q^T)^-1``. ``p`` counts up to the pixels that a reading of the image averages, 1.25 or
        ``4 pi smoothing^2`` if more: points further apart read noise of their own. Along the border of the mesh the
        smoothing gathers less noise. At a displacement with the gradient
        ``F`` it is ``F C F^T``, and the noise of the deformed image is averaged over ``det F`` times as many pixels.

        On a speckle of 5 pixels and cells of 20, with a noise of 5 to 10 % of the root mean square of the gradient per
        pixel, the scatter measured is 0.95 to 1.05 times the prediction, for every type of cell, by the default options
        and without their smoothing. Limits:

        - Only the scatter is predicted: not the bias of interpolation and noise, nor that of a mesh too coarse for the
          field.
        - The sensitivity is that of the analytic gradient: with ``gradient="finite-difference"`` the scatter is 0.9
          times the prediction.
        - Shape functions are taken as constant over the width of the smoothing: with one of 0.8 pixels in cells of 8,
          the scatter is 0.93 times the prediction.
        - Far fewer points than pixels scatter more than predicted after a smoothing.
        - The noise of the reference image adds to its gradient: with a noise of a third of the gradient and no
          smoothing, the scatter is 1.25 times the prediction.

        These figures are those of ``fedic experiment noise`` and of ``tests/unit/test_uncertainty.py``. The variances
        are entries of an inverse found by selected inversion: the cost is that of about six factorisations, once for
        the reference image and the points used. Another noise or displacement then takes milliseconds: the covariance
        at rest is carried by a factor for each node, as if ``det F`` were the same in all cells around it.
        """
        return self.covariance(noise, displacement).standard_deviations

    def covariance(self, noise: float, displacement: ArrayLike | None = None) -> Covariance:
        """Predict the covariance of the displacement from the noise of the images, all points being used.

        Parameters
        ----------
        noise : float
            As for `standard_deviations`.
        displacement : array_like, shape (n, 2), optional
            As for `standard_deviations`.

        Returns
        -------
        Covariance
            Of the nodes, and of strains, gauges and points. `Result.covariance` is that of a measurement, in which
            points may be left out.

        Raises
        ------
        OptionError
            If the noise is negative or not finite.
        """
        prediction = self._core.covariance(noise, displacement)
        cells = np.ones(self._mesh.num_cells, dtype=bool)
        return Covariance(self._mesh, noise, self._mesh.used_nodes, cells, prediction)


@with_options(CORRELATION_OPTIONS)
def correlate(
    reference: Image,
    deformed: Image,
    mesh: Mesh,
    camera: Camera = ImageFrame(),
    *,
    initial: Initial = "auto",
    mask: Mask | None = None,
    regularization: Regularization = "smooth",
    unit: str | None = None,
    progress: ProgressCallback | None = None,
    **options: "Unpack[CorrelationOptions]",
) -> Result:
    """Measure the displacement between two images.

    For several deformed images of one specimen use `Correlator`, which prepares the reference image once.

    Parameters
    ----------
    reference, deformed : ndarray of uint8, uint16 or float32, shape (height, width)
        The images of the specimen at rest and deformed.
    mesh : Mesh
        The mesh, in the physical space.
    camera : ImageFrame, FrontParallel or Pinhole
        Projects the mesh to the image. `ImageFrame` is for a mesh drawn in pixels.
    initial : {"auto", "zero", "pyramid", "fft", "features", "log-polar", "flow"}, Result or array_like of shape (n, 2)
        Initial displacement; see `Correlator`.
    mask : array_like of shape (height, width), or list of polygons, optional
        Pixels of the reference image that are left out; see `Correlator`.
    regularization : {"smooth"} or EquilibriumGap
        What `regularization_length` is the length of; see `Correlator`.
    unit : str, optional
        Unit of length of the mesh; see `Correlator`.
    progress : callable, optional
        See `Correlator.correlate`.
    {options}

    Returns
    -------
    Result
        The displacement, how it was reached, and the verdict on it.

    Raises
    ------
    OptionError, ImageError, MeshError, CameraError, SolveError
        As `Correlator` and `Correlator.correlate`.

    Warns
    -----
    ConvergenceWarning, QualityWarning
        As `Correlator.correlate`.
    """
    correlator = Correlator(
        reference,
        mesh,
        camera,
        initial=initial,
        mask=mask,
        regularization=regularization,
        unit=unit,
        progress=progress,
        **options,
    )
    return correlator.correlate(deformed, progress=progress)


def _estimated(start: Start, images: tuple[Image, Image], mesh: Mesh, camera: Camera) -> Floats:
    """Return the nodal displacement that an estimator finds."""
    from fedic.starts.candidate import nodal_displacement
    from fedic.starts.estimators import ESTIMATORS
    from fedic.starts.flow import dense_flow
    from fedic.starts.images import StartImages

    prepared = StartImages.of(*images, mesh, camera)
    found = dense_flow(prepared) if start == "flow" else ESTIMATORS[start](prepared)
    if not found:
        raise SolveError(
            f"initial={start!r} finds no motion that makes the images agree; check that both show the same specimen, "
            "or give an initial displacement per node"
        )
    return nodal_displacement(found[0].displacement, mesh, camera)


def _warn_of_extrapolation(camera: Camera, mesh: Mesh, places: Floats, what: str) -> None:
    outside = np.flatnonzero(mesh.used_nodes & ~camera.covers(places))
    if outside.size:
        warnings.warn(
            f"{outside.size} of {mesh.num_nodes} nodes {what} outside the domain the lens was calibrated in, the first "
            f"being node {outside[0]}: it is extrapolated there, and what is measured there with it.",
            CalibrationWarning,
            stacklevel=levels_within_fedic(),
        )


def _prepared_again(kind: type[Correlator], made_of: tuple[Any, ...], named: dict[str, Any]) -> Correlator:
    with warnings.catch_warnings():
        # They were given when the pickled correlator was made.
        warnings.simplefilter("ignore", CalibrationWarning)
        warnings.simplefilter("ignore", QualityWarning)
        return kind(*made_of, **named)
