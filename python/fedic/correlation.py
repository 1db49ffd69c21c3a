"""The measurement: from two images, a mesh and a camera to a displacement field."""

import sys
import warnings
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic import _core
from fedic._core import ImageFrame, Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.errors import CalibrationWarning, SolveError
from fedic.io.images import as_pair, let_go, own_image
from fedic.progress import ProgressCallback, core_callback
from fedic.quadrature import MeshQuadrature, PixelQuadrature, Quadrature
from fedic.result import Iteration, Result
from fedic.starts.fft import uniform_start

__all__ = ["Correlator", "correlate"]

Initial: TypeAlias = Literal["pyramid", "fft"] | ArrayLike | None
Interpolation: TypeAlias = Literal["bilinear", "bicubic", "bspline3", "bspline5"]


class Correlator:
    """A reference image, a mesh and a camera prepared once, to measure many deformed images.

    Parameters
    ----------
    reference : ndarray of uint8, uint16 or float32, shape (height, width)
        The image of the specimen at rest. It is copied, as the buffer of a camera may be filled again; an array that
        is read-only, such as ``read_image(path, mapped=True)`` gives, is kept as it is.
    mesh : Mesh
        The mesh, in the physical space.
    camera : ImageFrame, FrontParallel or Pinhole
        Projects the mesh to the image. `ImageFrame` is for a mesh drawn in pixels.
    quadrature : MeshQuadrature or PixelQuadrature
        Where the integral over the mesh is sampled.
    interpolation : {"bilinear", "bicubic", "bspline3", "bspline5"}
        How both images are interpolated between pixels.
    gradient : {"analytic", "finite-difference"}
        Gradient of the reference image: of the interpolant, or of central differences at the pixels.
    smoothing : float
        Standard deviation, in pixels, of a Gaussian smoothing of both images; 0 for none. It removes what no
        interpolation can follow: with the default the bias of the interpolation is at most 1e-4 px, for a noise
        higher by 0 to 7 % where speckles are about five pixels wide and by 30 % where they are one to three. Under a
        stretch by 1 % it costs an error of 6e-4 px. See ``docs/defaults.md``.
    brightness : {"global", "element"} or None
        Where the mean and the contrast of the deformed image are brought to those of the reference image.
    hessian : {"initial", "updated"}
        Whether the correlation matrix is kept or rebuilt at each iteration.
    initial : None, "pyramid", "fft" or array_like of shape (n, 2)
        The start: zero; coarse-to-fine images; one whole-pixel motion found over the whole image, for large motions;
        or given nodal displacements in the mesh's unit. On a mesh of a thousand cells or more all but coarse-to-fine
        images are followed by a smooth field fitted to a few hundred cells, where that lowers their residual.
    regularization_length : float or None
        Wavelength, in pixels of the reference image, below which the field is smoothed; None for no smoothing.
    tolerance : float
        Stop when the largest nodal correction is below this, in pixels.
    max_iterations : int
        Largest number of iterations.
    num_threads : int or None
        Number of threads; None for all the processors. The result does not depend on it.
    progress : callable, optional
        Called once the reference is prepared, with the arguments of the ``progress`` of `correlate`.

    Raises
    ------
    ImageError
        If the reference is no image fedic can use.
    MeshError
        If the mesh has inverted cells or does not project in the image.
    SolveError
        If an option is out of its range.
    """

    def __init__(
        self,
        reference: Image,
        mesh: Mesh,
        camera: Camera = ImageFrame(),
        *,
        quadrature: Quadrature = MeshQuadrature(),
        interpolation: Interpolation = "bspline5",
        gradient: Literal["analytic", "finite-difference"] = "analytic",
        smoothing: float = 0.8,
        brightness: Literal["global", "element"] | None = "global",
        hessian: Literal["initial", "updated"] = "initial",
        initial: Initial = None,
        regularization_length: float | None = None,
        tolerance: float = 1e-3,
        max_iterations: int = 50,
        num_threads: int | None = None,
        progress: ProgressCallback | None = None,
    ) -> None:
        self._reference = own_image(reference, "reference")
        self._mesh = mesh
        self._camera = camera
        self._initial = _checked_initial(initial, mesh)
        rule, density = _rule(quadrature)
        self._core = _core.Correlator(
            self._reference,
            mesh,
            camera,
            rule=rule,
            density=density,
            interpolation=interpolation,
            gradient=gradient,
            smoothing=smoothing,
            brightness=brightness,
            hessian=hessian,
            regularization_length=regularization_length,
            tolerance=tolerance,
            max_iterations=max_iterations,
            num_threads=num_threads,
            progress=core_callback(progress),
        )
        let_go(self._reference)
        _warn_of_extrapolation(camera, mesh, mesh.points, "of the mesh lie")

    @property
    def num_points(self) -> int:
        """Number of quadrature points."""
        return self._core.num_points

    def correlate(self, deformed: Image, initial: Initial = None, progress: ProgressCallback | None = None) -> Result:
        """Measure the displacement between the reference and one deformed image.

        Parameters
        ----------
        deformed : ndarray of uint8, uint16 or float32, shape (height, width)
            The image of the deformed specimen.
        initial : None, "pyramid", "fft" or array_like of shape (n, 2)
            The start of this frame; None takes the one given to the constructor.
        progress : callable, optional
            Called with (stage, pyramid level, iteration, largest correction in px, residual standard deviation).

        Returns
        -------
        Result
            The displacement and how it was reached. A measurement that did not converge has ``converged`` False.

        Raises
        ------
        ImageError
            If the deformed image cannot be used or is not of the size of the reference.
        SolveError
            If the images do not determine the displacement of some node, or the iterations diverge.
        """
        deformed = as_pair(self._reference, deformed)
        start = self._initial if initial is None else _checked_initial(initial, self._mesh)
        if isinstance(start, str) and start == "fft":
            start = uniform_start(self._reference, deformed, self._mesh, self._camera)
        solution = self._core.correlate(
            deformed,
            initial=start if isinstance(start, np.ndarray) else None,
            pyramid=isinstance(start, str),
            progress=core_callback(progress),
        )
        places = self._mesh.points.copy()
        places[:, :2] += solution.displacement
        _warn_of_extrapolation(self._camera, self._mesh, places, "have moved")
        return Result(
            mesh=self._mesh,
            camera=self._camera,
            displacement=solution.displacement,
            pixel_displacement=solution.pixel_displacement,
            converged=solution.converged,
            iterations=solution.iterations,
            history=[Iteration(*entry) for entry in solution.history],
            num_points=solution.num_points,
            residual_rms=solution.residual_rms,
            cell_residuals=solution.cell_residuals,
            outside_cells=solution.outside_cells,
        )

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
            centre lies outside the mesh.
        """
        return self._core.residual_map(as_pair(self._reference, deformed), displacement)

    def standard_deviations(self, noise: float) -> Floats:
        """Predict the standard deviation of the displacement from the noise of the images.

        Parameters
        ----------
        noise : float
            Standard deviation, in grey levels, of the noise of one image as recorded, before any smoothing.

        Returns
        -------
        ndarray of float64, shape (n, 2)
            Standard deviation of each node's displacement, in the mesh's unit; NaN at nodes that no cell uses.

        Raises
        ------
        SolveError
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
        ``4 pi smoothing^2`` if more: points further apart read noise of their own.

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

        These figures are those of ``fedic experiment noise`` and of ``tests/unit/test_uncertainty.py``. The cost is one
        solution of the system per unknown, shared by the threads.
        """
        return self._core.standard_deviations(noise)


def correlate(
    reference: Image,
    deformed: Image,
    mesh: Mesh,
    camera: Camera = ImageFrame(),
    *,
    quadrature: Quadrature = MeshQuadrature(),
    interpolation: Interpolation = "bspline5",
    gradient: Literal["analytic", "finite-difference"] = "analytic",
    smoothing: float = 0.8,
    brightness: Literal["global", "element"] | None = "global",
    hessian: Literal["initial", "updated"] = "initial",
    initial: Initial = None,
    regularization_length: float | None = None,
    tolerance: float = 1e-3,
    max_iterations: int = 50,
    num_threads: int | None = None,
    progress: ProgressCallback | None = None,
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
        Projects the mesh to the image.
    quadrature, interpolation, gradient, smoothing, brightness, hessian, initial, regularization_length, tolerance, \
max_iterations, num_threads
        See `Correlator`.
    progress : callable, optional
        See `Correlator.correlate`.

    Returns
    -------
    Result
        The displacement and how it was reached.

    Raises
    ------
    ImageError, MeshError, SolveError
        As `Correlator` and `Correlator.correlate`.
    """
    correlator = Correlator(
        reference,
        mesh,
        camera,
        quadrature=quadrature,
        interpolation=interpolation,
        gradient=gradient,
        smoothing=smoothing,
        brightness=brightness,
        hessian=hessian,
        initial=initial,
        regularization_length=regularization_length,
        tolerance=tolerance,
        max_iterations=max_iterations,
        num_threads=num_threads,
        progress=progress,
    )
    return correlator.correlate(deformed, progress=progress)


def _warn_of_extrapolation(camera: Camera, mesh: Mesh, places: Floats, what: str) -> None:
    outside = np.flatnonzero(mesh.used_nodes & ~camera.covers(places))
    if outside.size:
        warnings.warn(
            f"{outside.size} of {mesh.num_nodes} nodes {what} outside the domain the lens was calibrated in, the first "
            f"being node {outside[0]}: it is extrapolated there, and what is measured there with it.",
            CalibrationWarning,
            stacklevel=_levels_within_fedic(),
        )


def _levels_within_fedic() -> int:
    """Return how many calls up, counted from the caller, the code that uses fedic is."""
    levels, frame = 1, sys._getframe(1)
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).startswith("fedic."):
        levels, frame = levels + 1, frame.f_back
    return levels


def _rule(quadrature: Quadrature) -> tuple[Literal["rotated", "edges", "diameter", "pixel"], float]:
    if isinstance(quadrature, MeshQuadrature):
        return quadrature.rule, quadrature.density
    if isinstance(quadrature, PixelQuadrature):
        return "pixel", 1.0
    raise SolveError(f"quadrature is {quadrature!r}; give fedic.MeshQuadrature() or fedic.PixelQuadrature().")


def _checked_initial(initial: Initial, mesh: Mesh) -> Literal["pyramid", "fft"] | Floats | None:
    if initial is None or (isinstance(initial, str) and initial in ("pyramid", "fft")):
        return initial  # type: ignore[return-value]
    if isinstance(initial, str):
        raise SolveError(f'initial is {initial!r}; choose None, "pyramid", "fft" or an array of nodal displacements.')
    try:
        start = np.array(initial, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SolveError(f"initial is not an array of numbers ({error}).") from error
    if start.shape != (mesh.num_nodes, 2):
        raise SolveError(
            f"initial has shape {start.shape}; give one displacement per node, shape ({mesh.num_nodes}, 2)."
        )
    used = mesh.used_nodes
    start[~used] = 0.0
    bad = np.flatnonzero(~np.isfinite(start).all(axis=1))
    if bad.size:
        raise SolveError(f"initial is not finite at {bad.size} nodes, the first being node {bad[0]}.", bad.tolist())
    return start
