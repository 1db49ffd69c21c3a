"""Refinement of a motion of the whole mesh: Gauss-Newton for the six parameters of an affine map, coarse to fine."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fedic._internal.types import Floats
from fedic.starts.images import StartImages
from fedic.starts.motion import is_plausible
from fedic.starts.window import SMALLEST_OVERLAP, Grey, Match, Window, correlation, smoothed

__all__ = ["Refined", "refined"]

_SMOOTHINGS = (8.0, 4.0, 2.0, 1.0)
"""Standard deviations of the Gaussians, in pixels of the finest level."""
_ITERATIONS = 15
_ENOUGH_PX = 0.02
_SMALLEST_SCORE = 0.3
"""Correlation coefficient at each level below which the motion is given up."""
_CONDITION = 1e-6


@dataclass(frozen=True, eq=False)
class Refined:
    """A refined motion, shape (3, 3), in pixels, and how well it makes the images agree."""

    motion: Floats
    match: Match


def refined(images: StartImages, motion: Floats) -> Refined | None:
    """Refine a motion on images smoothed less and less.

    The increments are affine maps of the reference image, applied before the motion, so that homographies are refined
    as well. Mean and contrast of both images are made equal over the mesh in each iteration.

    Parameters
    ----------
    images : StartImages
        The two images and the region of the mesh.
    motion : ndarray of float64, shape (3, 3)
        Initial motion, in pixels.

    Returns
    -------
    Refined or None
        The refined motion; None if the mesh leaves the view, or the images correlate no better there than by chance.
    """
    corners = images.corners()
    for smoothing in _SMOOTHINGS:
        if not is_plausible(motion, corners):
            return None
        factor = max(1.0, smoothing / 2.0)
        window = Window(images, factor)
        found, score = _aligned(window, window.level.reduced(motion), smoothing / factor)
        if score < _SMALLEST_SCORE:
            return None
        motion = window.level.enlarged(found)
    if not is_plausible(motion, corners):
        return None
    match = Window(images).match(motion)
    return Refined(motion, match) if match.is_significant else None


def _aligned(window: Window, start: Floats, smoothing: float) -> tuple[Floats, float]:
    """Return the motion of the highest correlation met by the iterations of one level, and this correlation."""
    motion = best = np.asarray(start, dtype=np.float64)
    highest = -np.inf
    height, width = window.region.shape
    half = 0.5 * max(width, height)
    centre = window.low + 0.5 * np.array([width - 1.0, height - 1.0])
    to_unit = np.array([[1.0 / half, 0.0, -centre[0] / half], [0.0, 1.0 / half, -centre[1] / half], [0.0, 0.0, 1.0]])
    u, v = ((np.arange(length) - 0.5 * (length - 1)) / half for length in (width, height))
    for _ in range(_ITERATIONS):
        grey, weight = window.taken_back(motion)
        if float(weight.sum()) < SMALLEST_OVERLAP * float(window.region.sum()):
            break
        f, g = window.normalised(grey, weight)
        smooth_f, smooth_g = smoothed(f * weight, smoothing), smoothed(g * weight, smoothing)
        score = correlation(smooth_f, smooth_g)
        if score > highest:
            best, highest = motion, score
        slopes = [smoothed(slope * weight, smoothing) for slope in _gradient(0.5 * (f + g))]
        parameters = _increment(smooth_f - smooth_g, slopes, u, v)
        if parameters is None:
            break
        increment = np.eye(3)
        increment[:2] += parameters @ to_unit
        motion = np.asarray(motion @ increment, dtype=np.float64)
        if float(np.abs(parameters).sum(axis=1).max()) < _ENOUGH_PX:
            break
    return best, highest


def _gradient(image: Grey) -> tuple[Grey, Grey]:
    import cv2

    along_u, along_v = (cv2.Sobel(image, cv2.CV_32F, du, 1 - du, ksize=1, scale=0.5) for du in (1, 0))
    return np.asarray(along_u, dtype=np.float32), np.asarray(along_v, dtype=np.float32)


def _increment(residual: Grey, slopes: Sequence[Grey], u: Floats, v: Floats) -> Floats | None:
    """Return the rows of the least-squares displacement `rows @ (u, v, 1)` in pixels; None if it is not determined."""

    def moments(image: Grey) -> Floats:
        """Return the sums over the pixels of image times u^i v^j, shape (3, 3)."""
        found: Floats = np.vander(v, 3, increasing=True).T @ image.astype(np.float64) @ np.vander(u, 3, increasing=True)
        return found

    powers = ((1, 0), (0, 1), (0, 0))
    matrix: Floats = np.empty((6, 6))
    vector: Floats = np.empty(6)
    for row, slope in enumerate(slopes):
        found = moments(residual * slope)
        vector[3 * row : 3 * row + 3] = [found[j, i] for i, j in powers]
        for column, other in enumerate(slopes):
            found = moments(slope * other)
            block = [[found[j + m, i + k] for k, m in powers] for i, j in powers]
            matrix[3 * row : 3 * row + 3, 3 * column : 3 * column + 3] = block
    values = np.linalg.eigvalsh(matrix)
    if not values[0] > _CONDITION * values[-1]:
        return None
    return np.asarray(np.linalg.solve(matrix, vector).reshape(2, 3), dtype=np.float64)
