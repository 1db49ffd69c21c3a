"""A possible displacement of the mesh, and its conversion to the mesh's unit."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import Camera, Floats
from fedic.starts.images import StartImages
from fedic.starts.motion import moved
from fedic.starts.refinement import refined

__all__ = ["Candidate", "Estimator", "nodal_displacement", "refined_candidate"]


@dataclass(frozen=True, eq=False)
class Candidate:
    """A displacement of the mesh that an estimator found.

    Attributes
    ----------
    name : str
        The estimator: ``"fft"``, ``"features"``, ``"log-polar"`` or ``"flow"``.
    displacement : ndarray of float64, shape (n, 2)
        Displacement of the nodes in pixels; zero at nodes of no cell.
    score : float
        Correlation coefficient, from -1 to 1, between the reference image and the deformed one taken back by this
        displacement, over the part of the mesh that stays in view.
    overlap : float
        Share of the mesh's pixels that stay in view.
    motion : ndarray of float64, shape (3, 3)
        Affine map or homography of pixels that moves the whole mesh; the displacement of ``"flow"`` differs from it.
    alternatives : ndarray of float64, shape (k, 2)
        Other translations in pixels at which the images correlate nearly as well: the texture is periodic.
    """

    name: str
    displacement: Floats
    score: float
    overlap: float
    motion: Floats
    alternatives: Floats = field(default_factory=lambda: np.empty((0, 2)))


Estimator: TypeAlias = Callable[[StartImages], list[Candidate]]
"""Returns the candidates it finds, best first, and none where it finds nothing; it does not raise."""


def refined_candidate(
    images: StartImages, name: str, motion: Floats, alternatives: Floats | None = None
) -> Candidate | None:
    """Refine a motion, shape (3, 3) in pixels, and return its candidate; None if the images do not agree there."""
    found = refined(images, motion)
    if found is None:
        return None
    displacement = moved(found.motion, images.nodes) - images.nodes
    displacement[~np.isfinite(displacement).all(axis=1)] = 0.0
    others = np.empty((0, 2)) if alternatives is None else alternatives
    return Candidate(name, displacement, found.match.score, found.match.overlap, found.motion, others)


def nodal_displacement(displacement: Floats, mesh: Mesh, camera: Camera) -> Floats:
    """Convert displacements of the nodes in pixels to the mesh's unit.

    Parameters
    ----------
    displacement : ndarray of float64, shape (n, 2)
        Displacement of the nodes in the image, in pixels.
    mesh : Mesh
        The mesh.
    camera : camera
        Camera of both images.

    Returns
    -------
    ndarray of float64, shape (n, 2)
        Displacement in the plane of the mean ``z``; zero at nodes of no cell.

    Raises
    ------
    CameraError
        If the camera sees no point of the plane at the place of a node.
    """
    points, used = mesh.points, mesh.used_nodes
    z = float(points[used, 2].mean()) if points.shape[1] == 3 else 0.0
    pixels = camera.project(points[used])
    start = np.zeros((len(points), 2))
    start[used] = (camera.unproject(pixels + displacement[used], z) - camera.unproject(pixels, z))[:, :2]
    return start
