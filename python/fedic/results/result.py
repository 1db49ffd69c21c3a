"""The result of a measurement."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._core import Mesh
from fedic._internal.measurement import Measurement
from fedic._internal.types import Camera, Floats, StrPath
from fedic.errors import ImageError
from fedic.io.results import write_result
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
        Nodal displacements in the mesh's unit; NaN at nodes of no cell.
    pixel_displacement : ndarray of float, shape (n, 2)
        Nodal displacements in the image, ``(u, v)`` in pixels.
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
        Cells with points that left the deformed image; these points were not used.
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
    _measurement: Measurement | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        state = "converged" if self.converged else "not converged"
        return (
            f"Result({state} in {self.iterations} iterations, {self.mesh.num_nodes} nodes, {self.num_points} points, "
            f"residual_rms={self.residual_rms:.3g})"
        )

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
        return self.mesh.strains(self.displacement, measure, at, axes, centre=centre)

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
            centre lies outside the mesh.

        Raises
        ------
        ImageError
            If an image is no longer known or has changed since the measurement.

        Notes
        -----
        The correlator that measured is used if it still exists; otherwise it is prepared again.
        """
        return self._images().residual_map(self.displacement)

    def standard_deviations(self, noise: float) -> Floats:
        """Predict the standard deviation of the displacement from the noise of the images.

        Parameters
        ----------
        noise : float
            Standard deviation, in grey levels, of the noise of one image as recorded, before any smoothing.

        Returns
        -------
        ndarray of float, shape (n, 2)
            In the mesh's unit; NaN at nodes of no cell. See `Correlator.standard_deviations`.

        Raises
        ------
        OptionError
            If the noise is negative or not finite.
        ImageError
            If the reference image is no longer known or has changed since the measurement.
        """
        return self._images().standard_deviations(noise)

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
            For ParaView: ``displacement`` (mesh unit) and ``displacement_px`` on the nodes,
            ``green_lagrange_strain_xx``, ``..._yy``, ``..._xy`` (or ``hencky_strain_xx``, ``small_strain_xx``) and
            ``residual`` on the cells.
        ``.npz``
            Every array, for `numpy.load`; ``strain_measure`` names the measure of ``strains``.
        ``.json``
            The summary with the history and the measure, without the fields.

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
            ``num_cells``, ``num_points`` and ``outside_cells``.
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
        }

    def _arrays(self, measure: StrainMeasure) -> dict[str, NDArray[Any]]:
        return {
            "points": self.mesh.points,
            **{f"cells_{name}": nodes for name, nodes in self.mesh.cells.items()},
            "displacement": self.displacement,
            "pixel_displacement": self.pixel_displacement,
            "strains": self.strains(measure).components,
            "strain_measure": np.array(measure),
            "cell_residuals": self.cell_residuals,
            "outside_cells": self.outside_cells,
            "history": np.array(self.history, dtype=np.float64).reshape(-1, 4),
            "converged": np.array(self.converged),
            "error_left": np.array(self.error_left),
            "iterations": np.array(self.iterations),
            "num_points": np.array(self.num_points),
            "residual_rms": np.array(self.residual_rms),
        }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
