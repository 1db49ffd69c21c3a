"""Rotation and scale of the mesh from the log-polar spectra of windows of both images, then its translation."""

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.starts.candidate import Candidate, refined_candidate
from fedic.starts.images import Level, StartImages
from fedic.starts.motion import affine
from fedic.starts.template import correlation_map
from fedic.starts.window import Grey

__all__ = ["turned"]

_SIDE = 512.0
"""Larger side of the images of the search, in pixels."""
_SMALLEST_WINDOW = 32
_LARGEST_TEMPLATE = 128
_RADII, _ANGLES = 256, 720
"""Size of the log-polar spectra; the angles are those of a whole turn."""
_PADDING = 2
"""Length of the Fourier transform relative to the square's side; without, the grid of frequencies matches itself."""
_SMALLEST_RADIUS = 10.0
_LARGEST_SCALE = 2.5
_WINDOWS = 3
"""Number of windows of the deformed image along each side."""
_PARTS = (1.0, 0.6)
"""Sides of the squares of the reference image relative to the deformed one's; the second finds magnifications."""
_TRIED, _REFINED = 4, 2
"""Numbers of windows whose translation is searched for, and of motions that are refined."""


def turned(images: StartImages) -> list[Candidate]:
    """Find a rotation and a scale by phase correlation of log-polar spectra, then the translation by cross-correlation.

    The spectrum of the square around the mesh is compared with those of nine squares of the deformed image. It leaves
    half a turn open: both rotations are tried.

    Parameters
    ----------
    images : StartImages
        The two images and the region of the mesh.

    Returns
    -------
    list of Candidate
        One candidate named ``"log-polar"``, or none.
    """
    if not images.has_texture():
        return []
    level = images.level_of_side(_SIDE)
    tried = []
    for linear in _similarities(level):
        for half_turn in (1.0, -1.0):
            found = _placed(level, half_turn * linear)
            if found is not None:
                tried.append(found)
    tried.sort(key=lambda each: -each[0])
    candidates = [refined_candidate(images, "log-polar", level.enlarged(motion)) for _, motion in tried[:_REFINED]]
    return sorted((each for each in candidates if each is not None), key=lambda each: -each.score)[:1]


def _similarities(level: Level) -> list[Floats]:
    """Return the linear parts, shape (2, 2), of the similarities that agree best with the spectra, best first."""
    import cv2

    limits = np.array(level.region.shape[::-1])
    low, high = level.bounds()
    side = int(min(max((high + 1 - low).max(), 2 * _SMALLEST_WINDOW), limits.min()))
    if side < _SMALLEST_WINDOW:
        return []
    corner = np.clip(np.rint(0.5 * (low + high + 1 - side)).astype(np.int64), 0, limits - side)
    period = _PADDING * side
    expected = [
        _spectrum(level.reference, corner + int(0.5 * (1.0 - part) * side), int(part * side), period) for part in _PARTS
    ]
    taper = np.tile(np.hanning(_RADII), (_ANGLES // 2, 1)).astype(np.float32)
    per_unit = _RADII / math.log(period / 2.0)
    found = []
    for along in product(np.linspace(0.0, 1.0, _WINDOWS), repeat=2):
        there = np.rint(np.array(along) * (limits - side)).astype(np.int64)
        seen = _spectrum(level.deformed, there, side, period)
        for each in expected:
            (shift, turn), response = cv2.phaseCorrelate(each, seen, taper)
            scale, angle = math.exp(-shift / per_unit), 2.0 * math.pi * turn / _ANGLES
            if 1.0 / _LARGEST_SCALE <= scale <= _LARGEST_SCALE:
                cosine, sine = scale * math.cos(angle), scale * math.sin(angle)
                found.append((response, np.array([[cosine, -sine], [sine, cosine]])))
    found.sort(key=lambda each: -each[0])
    return [linear for _, linear in found[:_TRIED]]


def _spectrum(image: Grey, corner: NDArray[np.int64], side: int, period: int) -> Grey:
    """Return the log-polar spectrum of a square continued by zeros over half a turn, less its mean over the angles."""
    import cv2

    square = image[corner[1] : corner[1] + side, corner[0] : corner[0] + side]
    taper = np.hanning(side)
    square = (square - square.mean()) * taper * taper[:, np.newaxis]
    magnitude = np.fft.fftshift(np.abs(np.fft.fft2(square, (period, period))))
    centre = (float(period // 2), float(period // 2))
    flags = cv2.INTER_LINEAR | cv2.WARP_POLAR_LOG
    polar = cv2.warpPolar(np.log1p(magnitude).astype(np.float32), (_RADII, _ANGLES), centre, period / 2.0, flags)
    half = np.asarray(polar, dtype=np.float32)[: _ANGLES // 2]
    half = (half - half.mean(axis=0)) / (half.std(axis=0) + np.float32(1e-6))
    half[:, : math.ceil(_RADII * math.log(_SMALLEST_RADIUS) / math.log(period / 2.0))] = 0.0
    return np.asarray(half, dtype=np.float32)


def _placed(level: Level, linear: Floats) -> tuple[float, Floats] | None:
    """Return the correlation and the motion of the best translation, in pixels of the level; None if there is none."""
    import cv2

    height, width = level.deformed.shape
    corners = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]) @ np.linalg.inv(linear).T
    origin, extent = np.floor(corners.min(axis=0)), np.ptp(corners, axis=0)
    low, high = level.bounds()
    reduced = np.minimum(high + 1 - low, _LARGEST_TEMPLATE)
    first = low + (high + 1 - low - reduced) // 2
    template = level.reference[first[1] : first[1] + reduced[1], first[0] : first[0] + reduced[0]]
    size = np.ceil(extent).astype(int) + 1
    if (size < reduced).any() or (reduced < _SMALLEST_WINDOW // 4).any() or float(np.ptp(template)) == 0.0:
        return None
    rows = np.column_stack([linear, linear @ origin])
    back = cv2.warpAffine(
        level.deformed,
        rows,
        (int(size[0]), int(size[1])),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderValue=(float(level.deformed.mean()),),
    )
    scores = correlation_map(np.asarray(back, dtype=np.float32), template)
    v, u = np.unravel_index(int(np.argmax(scores)), scores.shape)
    shift = linear @ (np.array([u, v]) + origin - first)
    return float(scores[v, u]), affine(np.column_stack([linear, shift]))
