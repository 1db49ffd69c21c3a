"""The result of a measurement."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._core import Mesh
from fedic._internal.measurement import Measurement
from fedic._internal.types import Camera, Floats, StrPath
from fedic.errors import ImageError
from fedic.io.results import write_result

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
        True if the last correction was below the tolerance.
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

    def strains(self) -> Floats:
        """Return the small strains at the centre of each cell.

        Returns
        -------
        ndarray of float, shape (num_cells, 3)
            ``exx, eyy, exy``, tension positive; ``exy`` is the tensor component, half the engineering shear.
        """
        return self.mesh.strains(self.displacement)

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

    def write(self, path: StrPath) -> Path:
        """Write the result to a file, whole or not at all.

        ``.vtu`` and ``.vtk``
            For ParaView: ``displacement`` (mesh unit) and ``displacement_px`` on the nodes, ``strain_xx``,
            ``strain_yy``, ``strain_xy`` and ``residual`` on the cells.
        ``.npz``
            Every array, for `numpy.load`.
        ``.json``
            The summary, without the fields.

        Parameters
        ----------
        path : str or path
            The file to write; its suffix chooses the format.

        Returns
        -------
        Path
            The file written.

        Raises
        ------
        FedicError
            If the suffix is unknown or the file cannot be written.
        """
        history = [{name: _finite(value) for name, value in iteration._asdict().items()} for iteration in self.history]
        return write_result(Path(path), self.mesh, self._arrays(), {**self.summary(), "history": history})

    def summary(self) -> dict[str, Any]:
        """Return convergence, residual and sizes as JSON types.

        Returns
        -------
        dict
            ``converged``, ``iterations``, ``residual_rms`` (None if not finite), ``num_nodes``, ``num_cells``,
            ``num_points`` and ``outside_cells``.
        """
        return {
            "converged": self.converged,
            "iterations": self.iterations,
            "residual_rms": _finite(self.residual_rms),
            "num_nodes": self.mesh.num_nodes,
            "num_cells": self.mesh.num_cells,
            "num_points": self.num_points,
            "outside_cells": self.outside_cells.tolist(),
        }

    def _arrays(self) -> dict[str, NDArray[Any]]:
        return {
            "points": self.mesh.points,
            **{f"cells_{name}": nodes for name, nodes in self.mesh.cells.items()},
            "displacement": self.displacement,
            "pixel_displacement": self.pixel_displacement,
            "strains": self.strains(),
            "cell_residuals": self.cell_residuals,
            "outside_cells": self.outside_cells,
            "history": np.array(self.history, dtype=np.float64).reshape(-1, 4),
            "converged": np.array(self.converged),
            "iterations": np.array(self.iterations),
            "num_points": np.array(self.num_points),
            "residual_rms": np.array(self.residual_rms),
        }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
