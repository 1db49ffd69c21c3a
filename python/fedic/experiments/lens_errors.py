"""Measuring the known motion of the scene with a lens, with and without the model of that lens."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fedic._core import ImageFrame, Mesh
from fedic._internal.types import Floats, Progress
from fedic.correlation import Correlator, Initial, correlate
from fedic.errors import SolveError
from fedic.experiments.lens import MILLIMETRES, ROUNDING, Pair, Scene
from fedic.experiments.outcome import Row
from fedic.experiments.settings import UNFILTERED, Setting
from fedic.experiments.sweep import MOST_ITERATIONS, TOLERANCE, rms
from fedic.quadrature import Quadrature
from fedic.result import Result

__all__ = ["LensAccuracy", "Measurement", "measure", "measure_pairs", "rounding_bound", "sum_up"]


@dataclass(frozen=True, eq=False)
class Measurement:
    """One measurement against the truth.

    Attributes
    ----------
    name : str
        What was used.
    result : Result
        The measurement.
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


@dataclass(frozen=True)
class LensAccuracy:
    """Errors over the nodes, averaged over the textures.

    Attributes
    ----------
    bias : (float, float)
        Mean over the textures of the absolute mean error along ``u`` and ``v``, in pixels.
    std : (float, float)
        Mean over the textures of the standard deviation of the error, in pixels.
    iterations : int
        Most iterations.
    converged : bool
        Whether all measurements converged. Where one could not be made the figures are NaN.
    num_points : int
        Quadrature points.
    """

    bias: tuple[float, float]
    std: tuple[float, float]
    iterations: int
    converged: bool
    num_points: int

    def as_row(self) -> Row:
        """Return the entries of a table's row; ``std_px`` is the root mean square of both components."""
        return {
            "bias_u_px": self.bias[0],
            "bias_v_px": self.bias[1],
            "std_u_px": self.std[0],
            "std_v_px": self.std[1],
            "std_px": rms(np.array(self.std)),
            "iterations": self.iterations,
            "converged": self.converged,
            "points": self.num_points,
        }


def measure(
    scene: Scene,
    pair: Pair,
    mesh: Mesh,
    setting: Setting,
    quadrature: Quadrature,
    *,
    lens: bool,
    initial: Initial = "fft",
    progress: Progress | None = None,
) -> Measurement:
    """Measure one pair of images with one mesh.

    Parameters
    ----------
    scene : Scene
        Where the images come from.
    pair : Pair
        The images.
    mesh : Mesh
        In pixels.
    setting : Setting
        Interpolation, gradient and smoothing.
    quadrature : Quadrature
        Where the points lie.
    lens : bool
        Whether the mesh is brought to the plane, in millimetres, and projected by the calibrated camera; if not, it is
        left in pixels.
    initial : str or array_like
        The start.
    progress : callable, optional
        See `fedic.Correlator.correlate`.

    Returns
    -------
    Measurement
        With the errors of the nodes.

    Raises
    ------
    SolveError
        If the images do not determine the displacement.
    """
    start = time.perf_counter()
    result = correlate(
        pair.reference,
        pair.deformed,
        scene.in_millimetres(mesh) if lens else mesh,
        scene.camera if lens else ImageFrame(),
        quadrature=quadrature,
        initial=initial,
        tolerance=TOLERANCE,
        max_iterations=MOST_ITERATIONS,
        progress=progress,
        **setting.options,
    )
    seconds = time.perf_counter() - start
    if lens:
        return Measurement("mesh, with the lens", result, _in_pixels(result.displacement - scene.motion), seconds)
    return Measurement("pixels, without the lens", result, result.displacement - scene.pixel_motion, seconds)


def measure_pairs(
    scene: Scene, pairs: Sequence[Pair], mesh: Mesh, setting: Setting, quadrature: Quadrature, *, lens: bool
) -> LensAccuracy:
    """Measure several textures and sum up the errors.

    Parameters
    ----------
    scene : Scene
        Where the images come from.
    pairs : sequence of Pair
        One per texture.
    mesh, setting, quadrature, lens
        See `measure`.

    Returns
    -------
    LensAccuracy
        Over the nodes and the textures.
    """
    found = []
    for pair in pairs:
        try:
            found.append(measure(scene, pair, mesh, setting, quadrature, lens=lens))
        except SolveError:
            return LensAccuracy((np.nan, np.nan), (np.nan, np.nan), MOST_ITERATIONS, False, 0)
    return sum_up(found)


def sum_up(found: Sequence[Measurement]) -> LensAccuracy:
    """Average the errors of several measurements.

    Parameters
    ----------
    found : sequence of Measurement
        One per texture.

    Returns
    -------
    LensAccuracy
        Over the nodes and the textures.
    """
    bias = np.abs([each.bias for each in found]).mean(axis=0)
    std = np.mean([each.std for each in found], axis=0)
    return LensAccuracy(
        (float(bias[0]), float(bias[1])),
        (float(std[0]), float(std[1])),
        max(each.result.iterations for each in found),
        all(each.result.converged for each in found),
        found[0].result.num_points,
    )


def rounding_bound(scene: Scene, pair: Pair, mesh: Mesh) -> float:
    """Compute the Cramér-Rao bound of the displacement for the rounding of 8-bit images.

    Parameters
    ----------
    scene : Scene
        Where the images come from.
    pair : Pair
        In 8 bits.
    mesh : Mesh
        In pixels; measured through the camera, with one point per pixel and no smoothing.

    Returns
    -------
    float
        Root mean square over the nodes and both components of their least standard deviation, in pixels.
    """
    correlator = Correlator(
        pair.reference, scene.in_millimetres(mesh), scene.camera, quadrature=UNFILTERED.mesh, **UNFILTERED.options
    )
    return rms(_in_pixels(correlator.standard_deviations(ROUNDING)))


def _in_pixels(vectors: Floats) -> Floats:
    """Return vectors of the plane in pixels, `v` being down."""
    return vectors / MILLIMETRES * (1.0, -1.0)
