"""A later frame as the reference image: the moved mesh, and displacements counted from the first mesh."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.campaign.tracking.prediction import filled
from fedic.correlation import Correlator
from fedic.results import Quality, Result
from fedic.results.pixels import pixel_displacement

__all__ = ["Reference", "moved_mask", "moved_mesh"]


@dataclass(frozen=True, eq=False)
class Reference:
    """A reference image prepared on the mesh as it lies in it.

    Attributes
    ----------
    index : int
        Number of the frame; -1 for the first reference image.
    correlator : Correlator
        The prepared reference image.
    mesh : Mesh
        The first mesh, from which displacements are counted.
    displacement : ndarray of float64, shape (n, 2)
        Displacement from the first mesh to this image; filled where it was not measured.
    cell_flags, node_flags : ndarray of uint8
        Flags of the frame, which what is measured from it keeps.
    """

    index: int
    correlator: Correlator
    mesh: Mesh
    displacement: Floats
    cell_flags: NDArray[np.uint8]
    node_flags: NDArray[np.uint8]

    @classmethod
    def first(cls, correlator: Correlator, mesh: Mesh) -> "Reference":
        """Return the first reference image."""
        cells, nodes = (np.zeros(count, dtype=np.uint8) for count in (mesh.num_cells, mesh.num_nodes))
        return cls(-1, correlator, mesh, np.zeros((mesh.num_nodes, 2)), cells, nodes)

    @classmethod
    def of_frame(
        cls, index: int, image: Image, result: Result, prepare: Callable[[Image, Mesh, Any], Correlator], mask: Any
    ) -> "Reference":
        """Prepare a frame as the reference image.

        Parameters
        ----------
        index : int
            Number of the frame.
        image : ndarray, shape (height, width)
            Its image.
        result : Result
            Its result, counted from the first mesh.
        prepare : callable
            Returns the correlator of an image, a mesh and a mask.
        mask : ndarray of bool, shape (height, width), or None
            Pixels of the first reference image that are left out.

        Returns
        -------
        Reference
            The reference.

        Raises
        ------
        FedicError
            If the moved mesh does not fit the image.
        """
        displacement = filled(result.mesh, result.displacement)
        mesh = moved_mesh(result.mesh, displacement)
        moved = moved_mask(mask, result.mesh, displacement, mesh, result.camera)
        correlator = prepare(image, mesh, moved)
        quality = result.quality
        return cls(index, correlator, result.mesh, displacement, quality.cell_flags, quality.node_flags)

    def measure(self, deformed: Image, total: Floats | None, *, pyramid: bool = False) -> Result:
        """Measure a frame, its displacement counted from the first mesh.

        Parameters
        ----------
        deformed : ndarray, shape (height, width)
            The image.
        total : ndarray of float64, shape (n, 2), or None
            Initial displacement, counted from the first mesh; None for the start of the correlator.
        pyramid : bool
            Whether to begin on reduced images with an initial displacement.

        Returns
        -------
        Result
            The displacement from the first mesh.

        Raises
        ------
        FedicError
            As `Correlator.correlate`.
        """
        initial = None if total is None else total - self.displacement
        step = self.correlator.correlate(deformed, initial, pyramid=pyramid)
        return step if self.index < 0 else self._accumulated(step)

    def _accumulated(self, step: Result) -> Result:
        """Return the result counted from the first mesh."""
        camera, measurement = step.camera, step._measurement
        assert measurement is not None, "a measured result knows its images"
        unchecked = self.displacement + step.unchecked_displacement
        quality = _with_flags(step.quality, self.cell_flags, self.node_flags)
        displacement = np.where((quality.valid_nodes & self.mesh.used_nodes)[:, np.newaxis], unchecked, np.nan)
        return replace(
            step,
            mesh=self.mesh,
            displacement=displacement,
            pixel_displacement=pixel_displacement(camera, self.mesh.points, displacement),
            unchecked_displacement=unchecked,
            quality=quality,
            _measurement=replace(measurement, first=(self.mesh, self.displacement)),
        )


def moved_mesh(mesh: Mesh, displacement: Floats) -> Mesh:
    """Return a mesh moved by a displacement of its nodes, shape (n, 2)."""
    points = mesh.points.copy()
    points[:, :2] += displacement
    return Mesh(points, mesh.cells, mesh.sets)


def _with_flags(quality: Quality, cell_flags: NDArray[np.uint8], node_flags: NDArray[np.uint8]) -> Quality:
    """Add the flags of the reference frame: what was not measured there is not known later."""
    return replace(quality, cell_flags=quality.cell_flags | cell_flags, node_flags=quality.node_flags | node_flags)


def moved_mask(
    mask: NDArray[np.bool_] | None, mesh: Mesh, displacement: Floats, moved: Mesh, camera: Camera
) -> NDArray[np.bool_] | None:
    """Return the mask of the first reference image as it lies in a later one: that of the same material.

    Parameters
    ----------
    mask : ndarray of bool, shape (height, width), or None
        Pixels of the first reference image that are left out.
    mesh, moved : Mesh
        The first mesh, and the moved one.
    displacement : ndarray of float64, shape (n, 2)
        Displacement from the one to the other.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.

    Returns
    -------
    ndarray of bool, shape (height, width), or None
        The mask; false outside the moved mesh.
    """
    if mask is None:
        return None
    used = mesh.used_nodes
    nodes = camera.project(moved.points[used])
    height, width = mask.shape
    low = np.maximum(np.floor(nodes.min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil(nodes.max(axis=0)).astype(int) + 1, [width, height])
    carried = np.zeros_like(mask)
    columns = np.arange(low[0], high[0])
    z = float(mesh.points[used, 2].mean()) if mesh.points.shape[1] == 3 else 0.0
    for row in range(low[1], high[1]):
        pixels = np.column_stack([columns, np.full(len(columns), row)]).astype(np.float64)
        places = camera.unproject(pixels, z)[:, :2]
        back = moved.interpolate(-displacement, places)
        known = np.isfinite(back).all(axis=1)
        material = np.column_stack([places + np.nan_to_num(back), np.full(len(places), z)])
        first = np.rint(camera.project(material[:, : mesh.points.shape[1]])).astype(int)
        known &= ((first >= 0) & (first < [width, height])).all(axis=1)
        carried[row, columns[known]] = mask[first[known, 1], first[known, 0]]
    return carried
