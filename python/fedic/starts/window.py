"""The part of the images around the mesh, and how well a displacement makes them agree there."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.starts.images import StartImages

__all__ = ["SMALLEST_OVERLAP", "Grey", "Match", "Window", "correlation", "sampled", "smoothed"]

_SIDE = 500.0
"""Larger side of the mesh at the finest level, in pixels."""
_SMOOTHING = 1.0
_LOCAL = 32.0
"""Standard deviation, in pixels of the finest level, of the Gaussian under which local means are made equal."""
_STANDARD_DEVIATIONS = 6.0
_SMALLEST_SCORE, _LARGEST_THRESHOLD = 0.15, 0.8
SMALLEST_OVERLAP = 0.3
"""Smallest share of the mesh's pixels that must stay in view."""

Grey: TypeAlias = NDArray[np.float32]


@dataclass(frozen=True)
class Match:
    """How well two images agree over the part of the mesh that stays in view.

    Attributes
    ----------
    score : float
        Correlation coefficient.
    overlap : float
        Share of the mesh's pixels that stay in view.
    speckles : float
        Number of areas of the texture in view whose grey levels are independent.
    """

    score: float
    overlap: float
    speckles: float

    @property
    def is_significant(self) -> bool:
        """Whether enough of the mesh is in view, and the coefficient is larger than chance makes it."""
        chance = _STANDARD_DEVIATIONS / np.sqrt(max(self.speckles, 1.0))
        threshold = float(np.clip(chance, _SMALLEST_SCORE, _LARGEST_THRESHOLD))
        return self.overlap >= SMALLEST_OVERLAP and self.score >= threshold


class Window:
    """The box around the mesh in images reduced so that its larger side is at most 500 px, and by a further factor.

    Attributes
    ----------
    level : Level
        The reduced images.
    factor : float
        The further factor.
    low : ndarray of float64, shape (2,)
        First pixel (u, v) of the box.
    reference : ndarray of float32, shape (h, w)
        The reference image in the box.
    region : ndarray of bool, shape (h, w)
        Pixels inside the mesh.
    """

    def __init__(self, images: StartImages, factor: float = 1.0) -> None:
        low, high = images.bounds()
        self.factor = factor
        self.level = images.level(max(float((high - low).max()) / _SIDE, 1.0) * factor)
        low, high = self.level.bounds()
        rows, columns = slice(low[1], high[1] + 1), slice(low[0], high[0] + 1)
        self.low = low.astype(np.float64)
        self.reference = self.level.reference[rows, columns]
        self.region = self.level.region[rows, columns]

    def taken_back(self, motion: Floats, flow: Grey | None = None) -> tuple[Grey, Grey]:
        """Return the deformed image taken back to the box, and a weight of 1 at the mesh's pixels in view, 0 elsewhere.

        `motion`, in pixels of the level, follows `flow`, displacements (h, w, 2) in the box.
        """
        import cv2

        height, width = self.region.shape
        points = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(np.float32)
        points += self.low.astype(np.float32)
        if flow is not None:
            points += flow
        places = np.asarray(cv2.perspectiveTransform(points, motion), dtype=np.float32)
        limits = np.array(self.level.deformed.shape[::-1], dtype=np.float32) - 1.0
        inside = ((places >= 0.0) & (places <= limits)).all(axis=-1)
        return sampled(self.level.deformed, places), (self.region & inside).astype(np.float32)

    def normalised(self, grey: Grey, weight: Grey) -> tuple[Grey, Grey]:
        """Return the reference image and the one taken back, without local mean and of unit variance in the mesh."""
        f, g = (_normalised(image, weight, _LOCAL / self.factor) for image in (self.reference, grey))
        return f, g

    def match(self, motion: Floats, flow: Grey | None = None) -> Match:
        """Compare the images taken back by a motion, in pixels of the images as given, after a flow in the box."""
        grey, weight = self.taken_back(self.level.reduced(motion), flow)
        pixels = float(weight.sum())
        if pixels == 0.0:
            return Match(0.0, 0.0, 0.0)
        f, g = (smoothed(image * weight, _SMOOTHING) for image in self.normalised(grey, weight))
        return Match(correlation(f, g), pixels / float(self.region.sum()), _speckles(f))


def _speckles(image: Grey) -> float:
    """Return the area of an image in units of the integral of its squared autocorrelation, taken as a Gaussian.

    The squared width of a Gaussian autocorrelation is the variance of the grey levels over that of their slopes.
    """
    along_v, along_u = np.gradient(image)
    return (float(np.vdot(along_u, along_u)) + float(np.vdot(along_v, along_v))) / (
        2.0 * np.pi * max(float(np.var(image)), 1e-12)
    )


def sampled(image: Grey, places: Grey) -> Grey:
    """Return an image, or each of its channels, at places (h, w, 2), bilinearly; the border is repeated."""
    import cv2

    u, v = places[..., 0], places[..., 1]
    return np.asarray(cv2.remap(image, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), dtype=np.float32)


def _normalised(image: Grey, weight: Grey, sigma: float) -> Grey:
    """Return an image less its local mean, scaled to unit variance under the weights."""
    centred = image - _local_mean(image, weight, sigma)
    deviation = np.sqrt(float(np.vdot(centred * centred, weight)) / float(weight.sum()))
    return np.asarray(centred / (deviation if deviation > 0.0 else 1.0), dtype=np.float32)


def _local_mean(image: Grey, weight: Grey, sigma: float) -> Grey:
    """Return the mean under the weights and a Gaussian, computed on images reduced by a quarter of its width."""
    import cv2

    height, width = image.shape
    factor = max(1.0, sigma / 4.0)
    size = (max(1, round(width / factor)), max(1, round(height / factor)))
    mean = float(np.vdot(image, weight)) / float(weight.sum())
    total, share = (
        smoothed(np.asarray(cv2.resize(each, size, interpolation=cv2.INTER_AREA), dtype=np.float32), sigma / factor)
        for each in ((image - np.float32(mean)) * weight, weight)
    )
    local = total / np.maximum(share, np.float32(1e-3))
    enlarged = cv2.resize(local, (width, height), interpolation=cv2.INTER_LINEAR)
    return np.asarray(enlarged + mean, dtype=np.float32)


def smoothed(image: Grey, sigma: float) -> Grey:
    """Return an image after a Gaussian; outside it is zero."""
    import cv2

    return np.asarray(cv2.GaussianBlur(image, (0, 0), sigma, borderType=cv2.BORDER_CONSTANT), dtype=np.float32)


def correlation(f: Grey, g: Grey) -> float:
    """Return the correlation coefficient of two images of zero mean."""
    norms = float(np.linalg.norm(f)) * float(np.linalg.norm(g))
    return float(np.vdot(f, g)) / norms if norms > 0.0 else 0.0
