"""Sub-pixel position of the edge in an image across a projected feature.

Grey levels are sampled along the normals of the feature. One side of an edge, usually the background of a speckled
specimen, varies less than the other: with B its mean level, ``|I - B|`` is small on that side and large on the other,
be it brighter, darker, or speckled about the same mean. The mean of this contrast over a segment of the edge falls from
one level to another; the edge is the step function of the same area, whatever the blur. The area is a sum over pixels,
so that speckles average out.
"""

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh, interpolate_image
from fedic._internal.types import Floats, Image
from fedic.registration._pose import Placeable, pose_jacobian
from fedic.registration._sampling import Samples, image_normals

__all__ = ["Edge", "Strip", "across_jacobian", "measure_edge", "prepare_strip"]

_STEP_PX = 0.5
_NEIGHBOURS = 2
_SMALLEST_STEP = 0.3
"""Fraction of the median step below which a segment shows no edge."""
_LARGEST_REACH = 0.4
"""Largest search distance, relative to the distance of the next boundary of the mesh."""
_LARGEST_CLEARANCE_PX = 200.0
_CLEARANCE_STEP_PX = 2.0
_PROFILES_AT_ONCE = 256
_MARGIN_PX = 2
"""Margin around the points sampled, for the support of the interpolation."""


@dataclass(frozen=True, eq=False)
class Strip:
    """A feature with its sample points.

    Attributes
    ----------
    name : str
        Name of the feature.
    samples : Samples
        Points along the feature.
    clearance : float
        Median distance in pixels from the feature to the next boundary on either side.
    """

    name: str
    samples: Samples
    clearance: float

    @property
    def num_blocks(self) -> int:
        """Number of segments."""
        return int(self.samples.blocks[-1]) + 1

    def block_means(self, values: Floats) -> Floats:
        """Return the means over each segment of values at the samples, shape (n, ...)."""
        starts = np.searchsorted(self.samples.blocks, np.arange(self.num_blocks))
        counts = np.diff(np.append(starts, len(values)))
        sums = np.add.reduceat(values, starts, axis=0)
        means: Floats = sums / counts.reshape(-1, *[1] * (values.ndim - 1))
        return means


@dataclass(frozen=True, eq=False)
class Edge:
    """The edge found near a feature, by segments.

    Attributes
    ----------
    distances : ndarray, shape (b,)
        Distances from the projected feature, in pixels, positive out of the material.
    valid : ndarray of bool, shape (b,)
        True for segments with an edge of the common sign.
    pixels : ndarray, shape (b, 2)
        Image points of the edge.
    jacobian : ndarray, shape (b, p)
        Derivatives of the normal position of the feature with respect to the free parameters.
    inflation : float
        Variance of the mean distance relative to that estimated from the scatter of the segments, which share the
        levels of their two sides with their neighbours.
    """

    distances: Floats
    valid: NDArray[np.bool_]
    pixels: Floats
    jacobian: Floats
    inflation: float


def prepare_strip(name: str, mesh: Mesh, samples: Samples, camera: Placeable) -> Strip:
    """Measure the distance from a feature to the next boundary of the mesh."""
    pixel = 1.0 / np.linalg.norm(np.einsum("nij,nj->ni", camera.jacobian(samples.points), samples.normals), axis=1)
    some = np.unique(np.linspace(0, len(pixel) - 1, 40).astype(int))
    reach = np.arange(_CLEARANCE_STEP_PX, _LARGEST_CLEARANCE_PX, _CLEARANCE_STEP_PX)
    clearances = []
    for sign, expected in ((-1.0, True), (1.0, False)):
        offsets = sign * reach[:, np.newaxis] * pixel[some, np.newaxis, np.newaxis] * samples.normals[some, np.newaxis]
        places = (samples.points[some, np.newaxis] + offsets).reshape(-1, 3)
        inside = np.isfinite(mesh.interpolate(np.ones((mesh.num_nodes, 1)), places)).reshape(len(some), -1)
        changed = inside != expected
        # Next to a curved feature the chords of the mesh are on the wrong side: the first pixels do not count.
        changed[:, :2] = False
        clearances.append(np.where(changed.any(axis=1), reach[changed.argmax(axis=1)], _LARGEST_CLEARANCE_PX))
    return Strip(name, samples, float(np.median(np.minimum(*clearances))))


def measure_edge(
    image: Image, camera: Placeable, strip: Strip, names: tuple[str, ...], reach: float, band: float
) -> Edge:
    """Find the edge near a projected feature.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.
    camera : FrontParallel or Pinhole
        Camera that projects the feature near its edge.
    strip : Strip
        The feature.
    names : tuple of str
        The free parameters.
    reach : float
        Search distance in pixels; reduced if the next boundary is near.
    band : float
        Width in pixels of the bands beyond the search distance that give the levels of the two sides.

    Returns
    -------
    Edge
        The edge; NaN outside the image.
    """
    reach = min(reach, _LARGEST_REACH * strip.clearance)
    band = min(band, strip.clearance - reach)
    offsets = np.arange(-reach - band, reach + band + 0.5 * _STEP_PX, _STEP_PX)
    centres, normals = camera.project(strip.samples.points), image_normals(camera, strip.samples)
    places = centres[:, np.newaxis] + offsets[:, np.newaxis] * normals[:, np.newaxis]
    grey = _grey_levels(image, places)
    inner, outer, middle = offsets < -reach, offsets > reach, np.abs(offsets) <= reach

    contrast = _contrast(grey, inner, outer, strip)
    profile = strip.block_means(contrast)
    inside, outside = _smoothed(profile[:, inner].mean(axis=1)), _smoothed(profile[:, outer].mean(axis=1))
    step = inside - outside
    with np.errstate(divide="ignore", invalid="ignore"):
        covered = (profile[:, middle].mean(axis=1) - outside) / step
    distances = reach * (2.0 * covered - 1.0)
    typical = float(np.nanmedian(step)) if np.isfinite(step).any() else 0.0
    valid = np.isfinite(distances) & (np.abs(distances) <= 1.5 * reach)
    valid &= np.nan_to_num(step) * np.sign(typical) > _SMALLEST_STEP * abs(typical)
    mean_normals = strip.block_means(normals)
    # The sum over the reach and the level times the reach have variances as the reach over the band.
    inflation = (1.0 + reach / band) / (1.0 + reach / band / (2 * _NEIGHBOURS + 1))
    found = strip.block_means(centres) + distances[:, np.newaxis] * mean_normals
    return Edge(np.where(valid, distances, 0.0), valid, found, across_jacobian(camera, strip, names), inflation)


def across_jacobian(camera: Placeable, strip: Strip, names: tuple[str, ...]) -> Floats:
    """Return the derivatives (b, p) of the normal position of each segment of a feature."""
    slopes = pose_jacobian(camera, strip.samples.points, names)
    return strip.block_means(np.einsum("ni,nip->np", image_normals(camera, strip.samples), slopes))


def _grey_levels(image: Image, places: Floats) -> Floats:
    """Return the grey levels (n, k) at image points (n, k, 2); NaN outside the image.

    Consecutive profiles are sampled in groups, from the part of the image around them.
    """
    size = np.array(image.shape[::-1])
    grey = np.full(places.shape[:2], np.nan)
    for first in range(0, len(places), _PROFILES_AT_ONCE):
        profiles = slice(first, first + _PROFILES_AT_ONCE)
        near = ((places[profiles] > -1.0) & (places[profiles] < size)).all(axis=-1)
        if not near.any():
            continue
        some = places[profiles][near]
        low = np.maximum(np.floor(some.min(axis=0)).astype(int) - _MARGIN_PX, 0)
        high = np.minimum(np.ceil(some.max(axis=0)).astype(int) + _MARGIN_PX + 1, size)
        part = cast(Image, np.ascontiguousarray(image[low[1] : high[1], low[0] : high[0]]))
        grey[profiles][near] = interpolate_image(part, some - low, "bilinear")[0]
    return grey


def _contrast(grey: Floats, inner: NDArray[np.bool_], outer: NDArray[np.bool_], strip: Strip) -> Floats:
    """Return ``|I - B|``, with B the level near each sample of the side that varies less."""
    levels, variation = [], []
    for side in (inner, outer):
        level = _smoothed(strip.block_means(grey[:, side].mean(axis=1)))[strip.samples.blocks]
        levels.append(level)
        variation.append(
            np.nanmedian(np.abs(grey[:, side] - level[:, np.newaxis])) if np.isfinite(level).any() else 0.0
        )
    background = levels[int(np.argmin(variation))]
    contrast: Floats = np.abs(grey - background[:, np.newaxis])
    return contrast


def _smoothed(values: Floats) -> Floats:
    """Return moving averages along a feature, over two neighbours on either side."""
    kernel = np.ones(2 * _NEIGHBOURS + 1)
    known = np.isfinite(values)
    sums = np.convolve(np.where(known, values, 0.0), kernel, mode="full")
    counts = np.convolve(known.astype(np.float64), kernel, mode="full")
    inside = slice(_NEIGHBOURS, _NEIGHBOURS + len(values))
    with np.errstate(divide="ignore", invalid="ignore"):
        means: Floats = np.where(known, sums[inside] / counts[inside], np.nan)
    return means
