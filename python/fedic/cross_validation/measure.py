"""Measurement of a pair of images with several lengths of the regularization."""

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fedic._core import CELL_TYPES, CORRELATION_OPTIONS, ImageFrame, Mesh
from fedic._internal.masks import pixel_mask
from fedic._internal.types import Camera, Floats, Image
from fedic.correlation import Correlator, Mask
from fedic.cross_validation.curve import RegularizationCurve
from fedic.cross_validation.left_out import MOST_PATTERNS, left_out, square_sums
from fedic.errors import CalibrationWarning, ConvergenceWarning, OptionError, QualityWarning, SolveError
from fedic.options import with_options
from fedic.regularization import Regularization
from fedic.starts.initial import Initial

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from fedic.options import CorrelationOptions

__all__ = ["regularization_curve"]

_SHORTEST = 2.5
"""Shortest length by default, in mean edges of the cells."""
_RATIO = 2.0**0.5
"""Ratio of neighbouring lengths by default."""


@with_options([info for info in CORRELATION_OPTIONS if info.name != "regularization_length"])
def regularization_curve(
    reference: Image,
    deformed: Image,
    mesh: Mesh,
    camera: Camera = ImageFrame(),
    *,
    lengths: ArrayLike | None = None,
    regularization: Regularization = "smooth",
    patterns: int = 4,
    initial: Initial = "auto",
    mask: Mask | None = None,
    **options: "Unpack[CorrelationOptions]",
) -> RegularizationCurve:
    """Measure with several lengths of the regularization, and tell which predicts best what was not measured.

    Squares of 7 pixels are left out of the measurement, and the residual is read there afterwards: it holds the noise
    of the images, the noise of the displacement, which falls with the length, and its bias, which grows with it. The
    length of the least residual has the least error of the displacement over the mesh.

    Parameters
    ----------
    reference, deformed : ndarray of uint8, uint16 or float32, shape (height, width)
        The images of the specimen at rest and deformed.
    mesh : Mesh
        The mesh, in the physical space.
    camera : ImageFrame, FrontParallel or Pinhole
        Projects the mesh to the image.
    lengths : array_like of float, optional
        Lengths in pixels; by default from 2.5 mean edges of the cells to the size of the mesh, by factors of the square
        root of two.
    regularization : {"smooth"} or EquilibriumGap
        See `Correlator`.
    patterns : int
        Number of measurements with each length, from 1 to 9. Each leaves out another ninth of the pixels.
    initial : str, Result or array_like of shape (n, 2)
        Initial displacement of the first measurement; see `Correlator`. The others start from its result.
    mask : array_like of shape (height, width), or list of polygons, optional
        Pixels that are neither measured with nor read; see `Correlator`.
    {options}

    Returns
    -------
    RegularizationCurve
        The residuals; ``best_length`` is the length to use, ``plot()`` the picture.

    Raises
    ------
    OptionError
        If the lengths are not positive, or an option is wrong.
    SolveError
        If no length led to a measurement that converged.
    ImageError, MeshError, CameraError
        As `Correlator`.

    Notes
    -----
    Within the smoothing of the images, noise reaches from pixel to pixel. Points within twice the smoothing of a square
    are not measured with, nor are the outermost pixels of a square read. Robust weights flag cells anew in each
    measurement: give damaged parts as `mask` to compare the same pixels. A measurement without these squares has up to
    a quarter fewer points: its noise is up to 15 % higher, which makes the best length longer by 3 % at most.
    """
    shape = np.asarray(reference).shape
    if isinstance(patterns, bool) or not isinstance(patterns, int) or not 1 <= patterns <= MOST_PATTERNS:
        raise OptionError(f"patterns must be an integer from 1 to {MOST_PATTERNS}, got {patterns!r}", "patterns")
    if "regularization_length" in options:
        raise OptionError("regularization_length must be left out: give lengths", "regularization_length")
    steps = _checked_lengths(lengths, mesh, camera)
    named: dict[str, Any] = {**options, "regularization": regularization}
    masked = pixel_mask(mask, shape)
    with warnings.catch_warnings():
        # A length that is too short or too long leads to doubtful results; the curve says so.
        for category in (QualityWarning, ConvergenceWarning, CalibrationWarning):
            warnings.simplefilter("ignore", category)
        whole = Correlator(
            reference, mesh, camera, mask=masked, regularization_length=float(steps[len(steps) // 2]), **named
        )
        start = np.nan_to_num(whole.correlate(deformed, initial=initial).unchecked_displacement)
        rows = []
        for length in steps:
            counts, sums, residuals = [], [], []
            for pattern in range(patterns):
                hidden = left_out(shape, pattern)
                hidden = hidden if masked is None else hidden | masked
                part = Correlator(reference, mesh, camera, mask=hidden, regularization_length=float(length), **named)
                result = part.correlate(deformed, initial=start)
                residual = whole.residual_map(deformed, np.nan_to_num(result.unchecked_displacement))
                count, total = square_sums(residual, pattern)
                counts.append(count)
                sums.append(total if result.converged else np.full_like(total, np.nan))
                residuals.append(result.residual_rms)
            rows.append((np.concatenate(counts), np.concatenate(sums), float(np.mean(residuals))))
    return _curve(steps, rows)


def _curve(lengths: Floats, rows: list[tuple[Floats, Floats, float]]) -> RegularizationCurve:
    counts = np.array([row[0] for row in rows])
    # Pixels that left the image with some length are read with none.
    whole = (counts == counts[0]).all(axis=0) & (counts[0] > 0)
    sums, number = np.array([row[1] for row in rows])[:, whole], counts[0, whole].sum()
    mean_squares = sums.sum(axis=1) / max(number, 1.0)
    if number == 0 or np.isnan(mean_squares).all():
        raise SolveError(
            "no length of the regularization led to a measurement that converged; start closer to the solution"
        )
    best = int(np.nanargmin(mean_squares))
    rms = np.sqrt(mean_squares)
    # Squares are independent; the sum over them scatters by the square root of their number.
    differences = sums - sums[best]
    error = np.sqrt(sums.shape[1]) * differences.std(axis=1) / number / (2.0 * rms)
    return RegularizationCurve(lengths, rms, np.array([row[2] for row in rows]), error)


def _checked_lengths(lengths: ArrayLike | None, mesh: Mesh, camera: Camera) -> Floats:
    if lengths is None:
        pixels = camera.project(mesh.points)[mesh.used_nodes]
        shortest, longest = _SHORTEST * _mean_edge(mesh, camera), float(np.ptp(pixels, axis=0).max())
        number = max(2, 1 + round(np.log(max(longest / shortest, _RATIO)) / np.log(_RATIO)))
        return shortest * _RATIO ** np.arange(number)
    try:
        steps = np.unique(np.asarray(lengths, dtype=np.float64).ravel())
    except (TypeError, ValueError) as error:
        raise OptionError(f"lengths must be an array of numbers ({error})", "lengths") from error
    if steps.size < 2 or not (np.isfinite(steps) & (steps > 0.0)).all():
        raise OptionError(f"lengths must be at least two positive numbers of pixels, got {lengths!r:.80}", "lengths")
    return steps


def _mean_edge(mesh: Mesh, camera: Camera) -> float:
    pixels = camera.project(mesh.points)
    edges = []
    for name, outline in zip(mesh.cells, mesh.outlines(), strict=True):
        corners = pixels[outline[:, :: CELL_TYPES[name].edge_intervals]]
        edges.append(np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=-1).ravel())
    return float(np.concatenate(edges).mean())
