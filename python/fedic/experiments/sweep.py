"""Measurement of known motions and statistics of their errors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import Floats, Image
from fedic.correlation import Correlator
from fedic.errors import SolveError
from fedic.experiments.option_sets import UNFILTERED, OptionSet
from fedic.experiments.outcome import Row
from fedic.quadrature import MeshQuadrature, Quadrature
from fedic.synthetic import add_noise

__all__ = [
    "MAX_ITERATIONS",
    "TOLERANCE",
    "Accuracy",
    "draw_displacements",
    "measure_shifts",
    "noise_bound",
    "rms",
]

TOLERANCE = 1e-5
TOLERANCE_UNDER_NOISE = 1e-4
MAX_ITERATIONS = 400


@dataclass(frozen=True)
class Accuracy:
    """Errors of the measured displacement along ``u``, over the nodes, for several motions.

    Attributes
    ----------
    biases : tuple of float
        Absolute mean error of each motion, in pixels.
    stds : tuple of float
        Standard deviation of the error of each motion, in pixels.
    iterations : int
        Largest number of iterations.
    converged : bool
        True if all measurements converged. The errors are NaN if one failed.
    num_points : int
        Quadrature points.
    """

    biases: tuple[float, ...]
    stds: tuple[float, ...]
    iterations: int
    converged: bool
    num_points: int

    @property
    def bias(self) -> float:
        """Mean of the biases, in pixels."""
        return float(np.mean(self.biases))

    @property
    def std(self) -> float:
        """Mean of the standard deviations, in pixels."""
        return float(np.mean(self.stds))

    def as_row(self) -> Row:
        """Return the entries of a table's row."""
        return {
            "bias_px": self.bias,
            "std_px": self.std,
            "iterations": self.iterations,
            "converged": self.converged,
            "points": self.num_points,
        }


def measure_shifts(
    reference: Image,
    deformed: Sequence[Image],
    shifts: Sequence[tuple[float, float]],
    mesh: Mesh,
    setting: OptionSet,
    quadrature: Quadrature,
) -> Accuracy:
    """Measure images moved by known translations of the whole, without brightness correction.

    Parameters
    ----------
    reference : ndarray
        The image at rest.
    deformed : sequence of ndarray
        The images moved.
    shifts : sequence of (float, float)
        Their motions, in pixels.
    mesh : Mesh
        Mesh in pixels.
    setting : OptionSet
        Interpolation, gradient and smoothing.
    quadrature : Quadrature
        Quadrature rule.

    Returns
    -------
    Accuracy
        Over the nodes, for each motion.
    """
    correlator = Correlator(
        reference,
        mesh,
        quadrature=quadrature,
        brightness=None,
        tolerance=TOLERANCE,
        max_iterations=MAX_ITERATIONS,
        **setting.options,
    )
    biases, stds, iterations, converged = [], [], 0, True
    for image, shift in zip(deformed, shifts, strict=True):
        try:
            result = correlator.correlate(image, initial="zero")
        except SolveError:
            missing = (np.nan,) * len(shifts)
            return Accuracy(missing, missing, MAX_ITERATIONS, False, correlator.num_points)
        errors: Floats = result.unchecked_displacement[:, 0] - shift[0]
        biases.append(abs(float(errors.mean())))
        stds.append(float(errors.std()))
        iterations = max(iterations, result.iterations)
        converged &= result.converged
    return Accuracy(tuple(biases), tuple(stds), iterations, converged, correlator.num_points)


def noise_bound(reference: Image, mesh: Mesh, noise: float) -> float:
    """Compute the Cramér-Rao bound of the displacement under noise on both images.

    Parameters
    ----------
    reference : ndarray
        The image without that noise.
    mesh : Mesh
        Mesh in pixels.
    noise : float
        Standard deviation of the noise of each image, in grey levels.

    Returns
    -------
    float
        Root mean square over the nodes and both components, in pixels.
    """
    finest = MeshQuadrature(rule="diameter")
    return rms(Correlator(reference, mesh, quadrature=finest, **UNFILTERED.options).standard_deviations(noise))


def draw_displacements(
    reference: Image,
    deformed: Image,
    mesh: Mesh,
    setting: OptionSet,
    quadrature: Quadrature,
    noise: float,
    draws: int,
    *,
    start: tuple[float, float],
) -> Floats:
    """Measure pairs of images with independent Gaussian noise on both, without brightness correction.

    Parameters
    ----------
    reference, deformed : ndarray
        The images without that noise.
    mesh : Mesh
        Mesh in pixels.
    setting : OptionSet
        Interpolation, gradient and smoothing.
    quadrature : Quadrature
        Quadrature rule.
    noise : float
        Standard deviation of the noise of each image, in grey levels; the same draws at every call.
    draws : int
        Number of pairs.
    start : (float, float)
        Displacement the iterations start from, in pixels.

    Returns
    -------
    ndarray of float, shape (draws, n, 2)
        Nodal displacements, in pixels.
    """
    initial = np.broadcast_to(np.asarray(start), (mesh.num_nodes, 2))
    found = []
    for draw in range(draws):
        noisy_reference = add_noise(reference, noise=noise, seed=2 * draw)
        noisy_deformed = add_noise(deformed, noise=noise, seed=2 * draw + 1)
        correlator = Correlator(
            noisy_reference,
            mesh,
            quadrature=quadrature,
            brightness=None,
            tolerance=TOLERANCE_UNDER_NOISE,
            **setting.options,
        )
        found.append(correlator.correlate(noisy_deformed, initial=initial).unchecked_displacement)
    return np.stack(found)


def rms(values: Floats) -> float:
    """Return the root mean square.

    Parameters
    ----------
    values : ndarray
        Values, of any shape.

    Returns
    -------
    float
        Root mean square, in the unit of the values.
    """
    return float(np.sqrt(np.mean(values**2)))
