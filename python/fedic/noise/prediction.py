"""Standard deviations of the strains of cells, predicted from the noise of the images."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic import _core
from fedic._core import CORRELATION_OPTIONS, Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.io.images import as_image
from fedic.options import core_options

__all__ = ["MOST_NODES", "strain_deviations"]

MOST_NODES = 1500
"""Nodes up to which the covariance, a full matrix, is computed."""


def strain_deviations(
    image: Image, mesh: Mesh, camera: Camera, noise: float, options: Mapping[str, Any] | None = None
) -> Floats:
    """Predict the standard deviation of the strains at the centres of the cells.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The reference image.
    mesh : Mesh
        A mesh in a plane parallel to ``Z = 0``.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    noise : float
        Standard deviation of the noise of one image, in grey levels.
    options : mapping, optional
        Options of `fedic.correlate`; those of the start do not matter.

    Returns
    -------
    ndarray of float64, shape (num_cells, 3)
        Of ``exx``, ``eyy`` and the tensor component ``exy`` of small strains. NaN with a regularization, on a curved
        surface, or on a mesh of more than 1500 nodes.

    Raises
    ------
    OptionError, ImageError, MeshError, CameraError, SolveError
        As `fedic.Correlator`.

    Notes
    -----
    ``b C b^T`` with the strain operator ``b`` of the cell and the covariance ``C`` of all nodes, that of
    `Correlator.standard_deviations`. Nodal deviations alone do not tell it: neighbours are correlated.
    """
    found = np.full((mesh.num_cells, 3), np.nan)
    names = {info.name for info in CORRELATION_OPTIONS}
    given = {name: value for name, value in (options or {}).items() if name in names}
    heights = mesh.points[mesh.used_nodes, 2] if mesh.points.shape[1] > 2 else np.zeros(1)
    if given.get("regularization_length") is not None or mesh.num_nodes > MOST_NODES or np.ptp(heights) > 0.0:
        return found
    covariance = _covariance(as_image(image, "reference"), mesh, camera, noise, given)
    for first, nodes, apart in _blocks(mesh):
        dofs = (2 * nodes[:, :, np.newaxis] + np.arange(2)).reshape(len(nodes), -1)
        operator = _strain_operator(apart, nodes.shape[1])
        blocks = covariance[dofs[:, :, np.newaxis], dofs[:, np.newaxis, :]]
        variances = np.einsum("csi,cij,csj->cs", operator, blocks, operator)
        found[first : first + len(nodes)] = np.sqrt(np.maximum(variances, 0.0))
    return found


def _covariance(image: Image, mesh: Mesh, camera: Camera, noise: float, options: Mapping[str, Any]) -> Floats:
    """Return the covariance of the displacement of all nodes, (2 n, 2 n); NaN of nodes without points."""
    arguments = core_options(options, CORRELATION_OPTIONS)
    points, weights, cells = _core.Correlator(image, mesh, camera, **arguments).quadrature_points()
    interpolation, smoothing = arguments.get("interpolation", "bspline5"), arguments.get("smoothing", 0.8)
    jacobian = camera.jacobian(points)[:, :, :2]
    pixels = np.ones(len(points))
    if arguments.get("quadrature", ("rotated", 1.0))[0] != "pixel":
        pixels = weights * np.abs(np.linalg.det(jacobian))
    pixels = np.minimum(pixels, max(1.25, 4.0 * np.pi * smoothing**2))
    # Saturated points have no weight and stand for no pixel.
    spread = np.divide(weights**2, pixels, out=np.zeros_like(weights), where=pixels > 0.0)
    once, twice = _gradients(image, camera.project(points), interpolation, smoothing)
    once, twice = (np.einsum("nij,ni->nj", jacobian, gradient) for gradient in (once, twice))
    size = 2 * mesh.num_nodes
    hessian, gathered = np.zeros((size, size)), np.zeros((size, size))
    order = np.argsort(cells, kind="stable")
    starts = np.searchsorted(cells[order], np.arange(mesh.num_cells + 1))
    for first, nodes, apart in _blocks(mesh):
        shapes = _shape_functions(apart, nodes.shape[1], points[order[starts[first] : starts[first + len(nodes)]]])
        offset = starts[first]
        for cell, members in enumerate(nodes, start=first):
            at = order[starts[cell] : starts[cell + 1]]
            shape = shapes[starts[cell] - offset : starts[cell + 1] - offset]
            dofs = (2 * members[:, np.newaxis] + np.arange(2)).ravel()
            for matrix, gradient, weight in (
                (hessian, once[at], weights[at]),
                (gathered, twice[at], spread[at]),
            ):
                rows = (shape[:, :, np.newaxis] * gradient[:, np.newaxis, :]).reshape(len(at), -1)
                matrix[np.ix_(dofs, dofs)] += rows.T @ (weight[:, np.newaxis] * rows)
    kept = np.ix_(*2 * (np.diag(hessian) > 0.0,))
    inverse = np.linalg.inv(hessian[kept])
    covariance = np.full((size, size), np.nan)
    covariance[kept] = 2.0 * noise**2 * (inverse @ gathered[kept] @ inverse)
    return covariance


def _gradients(image: Image, pixels: Floats, interpolation: Any, smoothing: float) -> tuple[Floats, Floats]:
    """Return the gradient of the image as the measurement reads it, and that of the image smoothed once more."""
    once = _core.interpolate_image(image, pixels, interpolation, smoothing=smoothing)[1].astype(np.float64)
    if smoothing == 0.0:
        return once, once
    v, u = np.indices(image.shape).reshape(2, -1).astype(np.float64)
    smooth = _core.interpolate_image(image, np.column_stack([u, v]), interpolation, smoothing=smoothing)[0]
    twice = _core.interpolate_image(smooth.reshape(image.shape), pixels, interpolation, smoothing=smoothing)[1]
    return once, twice.astype(np.float64)


def _blocks(mesh: Mesh) -> Iterator[tuple[int, NDArray[np.int64], Mesh]]:
    """Yield the first cell of each block, its nodes, and a mesh of its cells without common nodes."""
    first = 0
    for kind, nodes in mesh.cells.items():
        apart = Mesh(mesh.points[nodes.ravel()], {kind: np.arange(nodes.size).reshape(nodes.shape)})
        yield first, nodes, apart
        first += len(nodes)


def _shape_functions(apart: Mesh, count: int, points: Floats) -> Floats:
    """Return the shape functions (n, count) at points that lie inside the cells."""
    local = np.tile(np.eye(count), (apart.num_cells, 1))
    return apart.interpolate(local, points)


def _strain_operator(apart: Mesh, count: int) -> Floats:
    """Return the strains (cells, 3, 2 count) at the centres that unit displacements of the nodes of a cell cause."""
    columns = []
    for local in range(count):
        for component in range(2):
            displacement = np.zeros((apart.num_nodes, 2))
            displacement[local::count, component] = 1.0
            columns.append(apart.strains(displacement, "small", "cells").components)
    return np.stack(columns, axis=-1)
