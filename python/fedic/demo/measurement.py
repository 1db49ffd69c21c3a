"""Measurement of the motion of the scene and its errors."""

import time
from dataclasses import dataclass
from typing import Any

from fedic._core import ImageFrame, Mesh
from fedic._internal.types import Floats
from fedic.correlation import correlate
from fedic.demo.scene import ImagePair, Scene
from fedic.plotting.error_maps import ErrorMap
from fedic.results import Result

__all__ = ["Measurement", "measure_pair"]


@dataclass(frozen=True, eq=False)
class Measurement:
    """A result and its errors.

    Attributes
    ----------
    name : str
        Name of the method in tables and figures.
    result : Result
        The result.
    errors : ndarray of float, shape (n, 2)
        Measured minus true displacement of the nodes along ``u`` and ``v``, in pixels.
    seconds : float
        Time of the correlation.
    """

    name: str
    result: Result
    errors: Floats
    seconds: float

    @property
    def bias(self) -> tuple[float, float]:
        """Mean of the errors, in pixels."""
        u, v = self.errors.mean(axis=0)
        return float(u), float(v)

    @property
    def std(self) -> tuple[float, float]:
        """Standard deviation of the errors, in pixels."""
        u, v = self.errors.std(axis=0)
        return float(u), float(v)

    @property
    def error_map(self) -> ErrorMap:
        """The errors, to be drawn over the reference image."""
        mesh, camera = self.result.mesh, self.result.camera
        return ErrorMap(self.name, mesh, camera.project(mesh.points), self.errors)


def measure_pair(scene: Scene, pair: ImagePair, mesh: Mesh, *, lens: bool, **options: Any) -> Measurement:
    """Measure one pair of images with one mesh.

    Parameters
    ----------
    scene : Scene
        The scene that the images show.
    pair : ImagePair
        The images.
    mesh : Mesh
        The mesh in pixels.
    lens : bool
        If true, the mesh is unprojected to the plane, in millimetres, and projected by the calibrated camera; if
        false, it stays in pixels.
    **options
        Options of `fedic.correlate`.

    Returns
    -------
    Measurement
        The result with the errors of the nodes.

    Raises
    ------
    SolveError
        If the images do not determine the displacement.
    """
    plane, camera = (scene.in_millimetres(mesh), scene.camera) if lens else (mesh, ImageFrame())
    start = time.perf_counter()
    result = correlate(pair.reference, pair.deformed, plane, camera, **options)
    seconds = time.perf_counter() - start
    if lens:
        return Measurement(
            "mesh, with the lens", result, scene.in_pixels(result.unchecked_displacement - scene.motion), seconds
        )
    return Measurement("pixels, without the lens", result, result.unchecked_displacement - scene.pixel_motion, seconds)
