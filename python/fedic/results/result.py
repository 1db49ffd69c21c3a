"""The result of a measurement."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._core import Mesh
from fedic._internal.measurement import Measurement
from fedic._internal.types import Camera, Floats, StrPath
from fedic.errors import FedicError, ImageError, OptionError
from fedic.io.results import write_result
from fedic.results.attempt import Attempt
from fedic.results.covariance import Covariance
from fedic.results.pixels import pixel_displacement
from fedic.results.quality import Quality
from fedic.results.rigid import RigidMotion, fit_rigid_motion
from fedic.results.strains import StrainAxes, StrainMeasure, Strains

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fedic.plotting.fields import Component, Strain

__all__ = ["Iteration", "Result"]


class Iteration(NamedTuple):
    """One Gauss-Newton iteration.

    Attributes
    ----------
    level : int
        Level of the pyramid; 0 is the full image.
    iteration : int
        Number of the iteration in its level.
    correction : float
        Largest nodal correction, in pixels.
    residual_rms : float
        Root mean square of the residual before the correction, in grey levels.
    """

    level: int
    iteration: int
    correction: float
    residual_rms: float


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """A displacement field and how it was reached.

    A result of `fedic.correlate` or `Correlator.correlate` refers to both images without copying them: images read by
    `fedic.read_image` by the names of their files, other arrays by reference. Pickling keeps the names of files only.

    Attributes
    ----------
    mesh : Mesh
        The mesh of the measurement.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera of the measurement.
    displacement : ndarray of float, shape (n, 2)
        Nodal displacements in the mesh's unit; NaN at nodes that were not measured: those of no valid cell.
    pixel_displacement : ndarray of float, shape (n, 2)
        Nodal displacements in the image, ``(u, v)`` in pixels; NaN at nodes that were not measured.
    converged : bool
        True if the error left by the iterations is below the tolerance.
    error_left : float
        Estimate of the largest error of a node that the iterations leave, in pixels.
    iterations : int
        Number of iterations on the images at full resolution; those on reduced images are in `history` alone.
    history : list of Iteration
        All iterations, those on reduced images first.
    num_points : int
        Number of quadrature points.
    residual_rms : float
        Root mean square of the residual over the mesh, in grey levels of the images as smoothed.
    cell_residuals : ndarray of float, shape (num_cells,)
        Root mean square of the residual in each cell, in grey levels of the images as smoothed.
    outside_cells : ndarray of int
        Cells with points that left the deformed image, or are saturated in it; these points were not used.
    unchecked_displacement : ndarray of float, shape (n, 2)
        Nodal displacements in the mesh's unit as the iterations left them, whatever the verdict; NaN at nodes of no
        cell.
    quality : Quality
        The verdict: evidence and flags of each cell and node.
    start : str
        The start that led here: ``"zero"``, ``"pyramid"``, ``"fft"``, ``"features"``, ``"log-polar"``, ``"flow"``,
        ``"given"``, or one of these followed by ``"+pyramid"``.
    information : tuple or None
        What each cell contributes to the covariance: its factors on the Hessian and on the noise, shape (num_cells, 2),
        the cells with robust weights, and the weights of their quadrature points. None if everything is one.
    attempts : tuple of Attempt
        What each start led to that ``"auto"`` tried; that of this result is the last.
    unit : str
        Unit of length of the mesh; empty if it was not given.
    """

    mesh: Mesh
    camera: Camera
    displacement: Floats
    pixel_displacement: Floats
    converged: bool
    error_left: float
    iterations: int
    history: list[Iteration]
    num_points: int
    residual_rms: float
    cell_residuals: Floats
    outside_cells: NDArray[np.int64]
    unchecked_displacement: Floats
    quality: Quality
    start: str
    information: tuple[Floats, list[int], list[NDArray[np.float32]]] | None = field(default=None, repr=False)
    attempts: tuple[Attempt, ...] = ()
    unit: str = ""
    _measurement: Measurement | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        state = "converged" if self.converged else "not converged"
        return (
            f"Result({state} in {self.iterations} iterations from {self.start!r}, {self.mesh.num_nodes} nodes, "
            f"{self.num_points} points, residual_rms={self.residual_rms:.3g}, {self.quality!r})"
        )

    @property
    def resolution(self) -> float | None:
        """Wavelength in pixels of the displacements whose amplitude the regularization halves; None without one.

        `standard_deviations` gives the noise that is left.
        """
        length = None if self._measurement is None else self._measurement.options.get("regularization_length")
        return None if length is None else float(length)

    @property
    def valid_nodes(self) -> NDArray[np.bool_]:
        """Nodes that were measured, shape (n,): those of at least one valid cell."""
        return self.quality.valid_nodes & self.mesh.used_nodes

    @property
    def valid_cells(self) -> NDArray[np.bool_]:
        """Cells whose texture was measured, shape (num_cells,); see `Quality`."""
        return self.quality.valid_cells

    def at(self, points: ArrayLike) -> Floats:
        """Evaluate the displacement anywhere in the mesh.

        Parameters
        ----------
        points : array_like, shape (m, 2 or 3)
            In the mesh's unit.

        Returns
        -------
        ndarray of float, shape (m, 2)
            In the mesh's unit; NaN outside the mesh.
        """
        return self.mesh.interpolate(self.displacement, points)

    def strains(
        self,
        measure: StrainMeasure = "green-lagrange",
        at: Literal["cells", "nodes"] | ArrayLike = "cells",
        axes: StrainAxes | None = None,
        *,
        centre: ArrayLike | None = None,
    ) -> Strains:
        """Return the strains at the cells, the nodes or any points.

        Parameters
        ----------
        measure : {"green-lagrange", "hencky", "small"}
            Strain measure. Green-Lagrange and Hencky strains are not changed by a rotation; the small strain of a
            rotation by 10 degrees is -1.5 %.
        at : {"cells", "nodes"} or array_like of shape (m, 2) or (m, 3)
            Centres of the cells, nodes (by L2 projection), or points in the mesh's frame.
        axes : float or "cylindrical", optional
            Axes of the components: those of the mesh's frame, turned counter-clockwise by an angle in radians, or
            radial and circumferential about `centre`. See `Mesh.strains` for surfaces in space.
        centre : array_like, shape (2,), optional
            Centre of cylindrical axes; the origin of the mesh's frame by default.

        Returns
        -------
        Strains
            ``exx, eyy, exy``, principal strains and directions, von Mises strains; tension positive, shear as the
            tensor component. NaN outside the mesh, in cells with a node that was not measured, and at nodes of no other
            cell.

        Raises
        ------
        OptionError
            If an argument is unknown or has the wrong shape.
        """
        return self.mesh.strains(self.displacement, measure, at, axes, centre=centre, valid_cells=self.valid_cells)

    def rigid_motion(self) -> RigidMotion:
        """Fit a rigid motion of any size to the displacement of the measured nodes.

        Returns
        -------
        RigidMotion
            ``translation`` of the centre of the measured nodes in the mesh's unit, ``rotation`` in radians, and the
            ``residual`` of each node, (n, 2); NaN if fewer than two nodes were measured.
        """
        return fit_rigid_motion(self.mesh.points[:, :2], self.displacement)

    def without_rigid_motion(self) -> "Result":
        """Take the rigid motion out of the displacement: the deformed mesh is shifted and turned back.

        Returns
        -------
        Result
            ``displacement``, ``unchecked_displacement`` and ``pixel_displacement`` without `rigid_motion`, in the
            mesh's frame. Green-Lagrange and Hencky strains, residuals, flags and history are those of the measurement.
            The deformed image shows the motion, so the result no longer refers to the images: `plot`, `residual_map`
            and `covariance` are those of the measured result.

        Raises
        ------
        FedicError
            If fewer than two nodes were measured.
        """
        motion, points = self.rigid_motion(), self.mesh.points
        if math.isnan(motion.rotation):
            raise FedicError("The rigid motion is not known: fewer than two nodes of the result were measured.")
        displacement = motion.taken_from(points[:, :2], self.displacement)
        return replace(
            self,
            displacement=displacement,
            pixel_displacement=pixel_displacement(self.camera, points, displacement),
            unchecked_displacement=motion.taken_from(points[:, :2], self.unchecked_displacement),
            _measurement=None,
        )

    def plot(
        self,
        field: "Component | Strain" = "eyy",
        *,
        measure: StrainMeasure = "green-lagrange",
        on: Literal["deformed", "reference"] = "deformed",
    ) -> "Figure":
        """Draw a displacement or a strain over the image.

        Parameters
        ----------
        field : {"exx", "eyy", "exy", "e1", "e2", "von_mises", "x", "y", "u", "v"}
            Component of the strain, principal strain or von Mises strain, projected onto the nodes (see `Strains`), or
            component of the displacement: ``x``, ``y`` in the mesh's unit, ``u``, ``v`` in pixels.
        measure : {"green-lagrange", "hencky", "small"}
            Measure of the strain; the colour bar names it.
        on : {"deformed", "reference"}
            Image over which the mesh is drawn, in that configuration.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; its method ``savefig`` writes it.

        Raises
        ------
        OptionError
            If an argument is unknown.
        ImageError
            If the image is no longer known or has changed since the measurement.
        """
        from fedic.plotting import plot_field

        images = self._images()
        image = images.reference if on == "reference" else images.deformed
        return plot_field(self, image.read(), field, measure=measure, on=on)

    def residual_map(self) -> NDArray[np.float32]:
        """Map the grey-level residual over the reference image.

        Returns
        -------
        ndarray of float32, shape (height, width)
            ``f - g`` of the images as smoothed, after the brightness correction, in grey levels; NaN at pixels whose
            centre lies outside the mesh or is masked. The displacement is the unchecked one, so that the residual
            shows why a cell is flagged.

        Raises
        ------
        ImageError
            If an image is no longer known or has changed since the measurement.

        Notes
        -----
        The correlator that measured is used if it still exists; otherwise it is prepared again.
        """
        return self._images().residual_map(np.nan_to_num(self.unchecked_displacement))

    def covariance(self, noise: float | None = None) -> Covariance:
        """Predict the covariance of the displacement from the noise of the images.

        Parameters
        ----------
        noise : float, optional
            Standard deviation, in grey levels, of the noise of one image as recorded, before any smoothing; by default
            that of the verdict, ``quality.noise``.

        Returns
        -------
        Covariance
            Of the displacement of the nodes, and of strains, gauges and points; through smoothing, regularization and
            robust weights. See `Correlator.standard_deviations`.

        Raises
        ------
        OptionError
            If the noise is negative or not finite, or there is none.
        ImageError
            If the reference image is no longer known or has changed since the measurement.
        """
        level = self.quality.noise if noise is None else noise
        if noise is None and not math.isfinite(level):
            raise OptionError("the noise of the images is not known: give it as noise, in grey levels", "noise")
        displacement = np.nan_to_num(self.unchecked_displacement)
        found = self._images().covariance(level, displacement, self.information)
        return Covariance(self.mesh, float(level), self.valid_nodes, self.valid_cells, found)

    def standard_deviations(self, noise: float | None = None) -> Floats:
        """Predict the standard deviation of the displacement from the noise of the images.

        Parameters
        ----------
        noise : float, optional
            Standard deviation of the noise of one image, in grey levels; see `covariance`.

        Returns
        -------
        ndarray of float, shape (n, 2)
            In the mesh's unit; NaN at nodes that were not measured, and everywhere if the noise is not known.

        Raises
        ------
        OptionError
            If the noise is negative or not finite.
        ImageError
            If the reference image is no longer known or has changed since the measurement.
        """
        if noise is None and not math.isfinite(self.quality.noise):
            return np.full(self.displacement.shape, np.nan)
        return self.covariance(noise).standard_deviations

    def _images(self) -> Measurement:
        if self._measurement is None:
            raise ImageError(
                "This result does not know its images, as it was not made by fedic.correlate; prepare a "
                "fedic.Correlator with the reference image and use its residual_map and standard_deviations."
            )
        return self._measurement

    def write(self, path: StrPath, *, measure: StrainMeasure = "green-lagrange") -> Path:
        """Write the result to a file, whole or not at all.

        ``.vtu`` and ``.vtk``
            For ParaView: ``displacement`` and its ``standard_deviation`` (mesh unit) and ``displacement_px`` on the
            nodes, ``green_lagrange_strain_xx``, ``..._yy``, ``..._xy`` (or ``hencky_strain_xx``, ``small_strain_xx``),
            their standard deviations ``green_lagrange_strain_std_xx`` and so on,
            ``residual`` and ``correlation`` on the cells; ``flags`` on both (zero where nothing is doubtful), and
            ``converged`` and ``good`` as field data of the ``.vtu``, whose ``displacement`` has the unit of the mesh as
            VTK's ``UNITS_LABEL`` if it was given.
        ``.npz``
            Every array, for `numpy.load`; ``strain_measure`` names the measure of ``strains`` and
            ``strain_standard_deviations``.
        ``.json``
            The summary with the history and the measure, without the fields.

        The standard deviations are those of `covariance`; NaN if the noise is not known, or the reference image is not
        any more.

        Parameters
        ----------
        path : str or path
            The file to write; its suffix chooses the format.
        measure : {"green-lagrange", "hencky", "small"}
            Strain measure of the file, which names it.

        Returns
        -------
        Path
            The file written.

        Raises
        ------
        OptionError
            If the suffix or the measure is unknown.
        FedicError
            If the file cannot be written.
        """
        history = [{name: _finite(value) for name, value in iteration._asdict().items()} for iteration in self.history]
        summary = {**self.summary(), "strain_measure": measure, "history": history}
        return write_result(Path(path), self.mesh, self._arrays(measure), summary)

    def summary(self) -> dict[str, Any]:
        """Return convergence, residual and sizes as JSON types.

        Returns
        -------
        dict
            ``converged``, ``error_left`` and ``residual_rms`` (None if not finite), ``iterations``, ``num_nodes``,
            ``num_cells``, ``num_points``, ``outside_cells``, ``resolution``, ``unit`` (None if it was not given),
            ``start``, ``attempts`` (list of dict) and ``quality``, the summary of the verdict.
        """
        return {
            "converged": self.converged,
            "error_left": _finite(self.error_left),
            "iterations": self.iterations,
            "residual_rms": _finite(self.residual_rms),
            "num_nodes": self.mesh.num_nodes,
            "num_cells": self.mesh.num_cells,
            "num_points": self.num_points,
            "outside_cells": self.outside_cells.tolist(),
            "resolution": self.resolution,
            "unit": self.unit or None,
            "start": self.start,
            "attempts": [_with_finite(attempt._asdict()) for attempt in self.attempts],
            "quality": self.quality.summary(),
        }

    @cached_property
    def _covariance(self) -> Covariance | None:
        """Covariance for the noise of the verdict; None if it is not known, or the reference image is not any more."""
        try:
            return self.covariance()
        except (ImageError, OptionError):
            return None

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_covariance"}

    def _deviations(self, measure: StrainMeasure) -> tuple[Floats, Floats]:
        """Return the standard deviations of the nodes and of the strains of the cells; NaN if they are not known."""
        if self._covariance is None:
            return np.full(self.displacement.shape, np.nan), np.full((self.mesh.num_cells, 3), np.nan)
        return self._covariance.standard_deviations, self._covariance.strain_deviations(measure)

    def _arrays(self, measure: StrainMeasure) -> dict[str, NDArray[Any]]:
        strains = self.strains(measure).components
        standard_deviations, strain_deviations = self._deviations(measure)
        return {
            "points": self.mesh.points,
            **{f"cells_{name}": nodes for name, nodes in self.mesh.cells.items()},
            "displacement": self.displacement,
            "pixel_displacement": self.pixel_displacement,
            "strains": strains,
            "strain_measure": np.array(measure),
            "standard_deviations": standard_deviations,
            "strain_standard_deviations": strain_deviations,
            "cell_residuals": self.cell_residuals,
            "outside_cells": self.outside_cells,
            "history": np.array(self.history, dtype=np.float64).reshape(-1, 4),
            "converged": np.array(self.converged),
            "error_left": np.array(self.error_left),
            "iterations": np.array(self.iterations),
            "num_points": np.array(self.num_points),
            "residual_rms": np.array(self.residual_rms),
            "unchecked_displacement": self.unchecked_displacement,
            "valid_nodes": self.valid_nodes,
            "valid_cells": self.valid_cells,
            "node_flags": self.quality.node_flags,
            "cell_flags": self.quality.cell_flags,
            "cell_correlation": self.quality.correlation,
            "cell_kept_share": self.quality.kept_share,
            "node_standard_deviation_px": self.quality.standard_deviation,
            "noise": np.array(self.quality.noise),
            "good": np.array(self.quality.is_good),
            "start": np.array(self.start),
            "unit": np.array(self.unit),
        }


def _with_finite(entries: dict[str, Any]) -> dict[str, Any]:
    return {name: _finite(value) if isinstance(value, float) else value for name, value in entries.items()}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
