"""Errors of the measured motion of the scene with a lens, with and without the model of the lens."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fedic._core import Mesh
from fedic.correlation import Correlator
from fedic.demo.measurement import Measurement, measure_pair
from fedic.demo.scene import ImagePair, Scene
from fedic.errors import SolveError
from fedic.experiments.lens import ROUNDING
from fedic.experiments.option_sets import UNFILTERED, OptionSet
from fedic.experiments.outcome import Row
from fedic.experiments.sweep import MAX_ITERATIONS, TOLERANCE, rms
from fedic.quadrature import Quadrature
from fedic.starts.initial import Initial

__all__ = ["LensAccuracy", "average_errors", "measure", "measure_pairs", "rounding_bound"]


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
        Largest number of iterations.
    converged : bool
        True if all measurements converged. The errors are NaN if one failed.
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
    pair: ImagePair,
    mesh: Mesh,
    setting: OptionSet,
    quadrature: Quadrature,
    *,
    lens: bool,
    initial: Initial = "fft",
) -> Measurement:
    """Measure one pair of images with one mesh.

    Parameters
    ----------
    scene : Scene
        Scene of the images.
    pair : ImagePair
        The images.
    mesh : Mesh
        Mesh in pixels.
    setting : OptionSet
        Interpolation, gradient and smoothing.
    quadrature : Quadrature
        Quadrature rule.
    lens : bool
        See `fedic.demo.measurement.measure_pair`.
    initial : str or array_like
        Start.

    Returns
    -------
    Measurement
        Result with the errors of the nodes.

    Raises
    ------
    SolveError
        If the images do not determine the displacement.
    """
    return measure_pair(
        scene,
        pair,
        mesh,
        lens=lens,
        quadrature=quadrature,
        initial=initial,
        tolerance=TOLERANCE,
        max_iterations=MAX_ITERATIONS,
        **setting.options,
    )


def measure_pairs(
    scene: Scene, pairs: Sequence[ImagePair], mesh: Mesh, setting: OptionSet, quadrature: Quadrature, *, lens: bool
) -> LensAccuracy:
    """Measure several textures and average the errors.

    Parameters
    ----------
    scene : Scene
        Scene of the images.
    pairs : sequence of ImagePair
        One per texture.
    mesh, setting, quadrature, lens
        See `measure`.

    Returns
    -------
    LensAccuracy
        Errors over the nodes and the textures.
    """
    found = []
    for pair in pairs:
        try:
            found.append(measure(scene, pair, mesh, setting, quadrature, lens=lens))
        except SolveError:
            return LensAccuracy((np.nan, np.nan), (np.nan, np.nan), MAX_ITERATIONS, False, 0)
    return average_errors(found)


def average_errors(found: Sequence[Measurement]) -> LensAccuracy:
    """Average the errors of several measurements.

    Parameters
    ----------
    found : sequence of Measurement
        One per texture.

    Returns
    -------
    LensAccuracy
        Errors over the nodes and the textures.
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


def rounding_bound(scene: Scene, pair: ImagePair, mesh: Mesh) -> float:
    """Compute the Cramér-Rao bound of the displacement for the rounding of 8-bit images.

    Parameters
    ----------
    scene : Scene
        Scene of the images.
    pair : ImagePair
        Images in 8 bits.
    mesh : Mesh
        Mesh in pixels; measured through the camera, with one point per pixel and no smoothing.

    Returns
    -------
    float
        Root mean square over the nodes and both components of their least standard deviation, in pixels.
    """
    correlator = Correlator(
        pair.reference, scene.in_millimetres(mesh), scene.camera, quadrature=UNFILTERED.mesh, **UNFILTERED.options
    )
    return rms(scene.in_pixels(correlator.standard_deviations(ROUNDING)))
