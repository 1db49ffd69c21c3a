"""Where the grey levels of an image change across a projected feature, to a fraction of a pixel.

Grey levels are read along the normals of the feature. One side of an edge is quieter than the other, as a rule the
ground around a speckled specimen: with B the level of the quiet side, ``|I - B|`` is small there and large on the
other, be it brighter, darker, or speckled about the same mean. The mean of this contrast over a piece of the edge
falls from a level on one side to a level on the other, and the area under it says where: at the step of the same
area, whatever the blur. The area is a sum over pixels, so that speckles cancel instead of pulling the edge to the
nearest of them.
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
"""Part of the median step below which a piece shows no edge."""
_ROOM = 0.4
"""Largest reach, in distances to the next boundary of the mesh."""
_FARTHEST_ROOM_PX = 200.0
_ROOM_STEP_PX = 2.0
_PROFILES_AT_ONCE = 256
_MARGIN_PX = 2
"""Around the points whose grey levels are read, for what the interpolation takes from their neighbours."""


@dataclass(frozen=True, eq=False)
class Strip:
    """A feature made ready.

    Attributes
    ----------
    name : str
        Of the feature.
    samples : Samples
        Points along it.
    room : float
        Distance in pixels, in the middle, from the feature to the next boundary on either side.
    """

    name: str
    samples: Samples
    room: float

    @property
    def num_blocks(self) -> int:
        """Number of pieces that are measured."""
        return int(self.samples.blocks[-1]) + 1

    def block_means(self, values: Floats) -> Floats:
        """Return the means over each piece of values at the samples, shape (n, ...)."""
        starts = np.searchsorted(self.samples.blocks, np.arange(self.num_blocks))
        counts = np.diff(np.append(starts, len(values)))
        sums = np.add.reduceat(values, starts, axis=0)
        means: Floats = sums / counts.reshape(-1, *[1] * (values.ndim - 1))
        return means


@dataclass(frozen=True, eq=False)
class Edge:
    """The edge found near a feature, piece by piece.

    Attributes
    ----------
    distances : ndarray, shape (b,)
        From the projected feature, in pixels, positive out of the material.
    valid : ndarray of bool, shape (b,)
        The pieces that show an edge of the common direction.
    pixels : ndarray, shape (b, 2)
        Where it is seen.
    jacobian : ndarray, shape (b, p)
        Derivatives of the feature's position across itself by the free parameters.
    inflation : float
        Variance of the mean distance over that which the scatter of the pieces shows: the levels of the two sides come
        from a band of finite width and from neighbouring pieces together.
    """

    distances: Floats
    valid: NDArray[np.bool_]
    pixels: Floats
    jacobian: Floats
    inflation: float


def prepare_strip(name: str, mesh: Mesh, samples: Samples, camera: Placeable) -> Strip:
    """Measure how much room there is around a feature before the next boundary of the mesh."""
    pixel = 1.0 / np.linalg.norm(np.einsum("nij,nj->ni", camera.jacobian(samples.points), samples.normals), axis=1)
    some = np.unique(np.linspace(0, len(pixel) - 1, 40).astype(int))
    reach = np.arange(_ROOM_STEP_PX, _FARTHEST_ROOM_PX, _ROOM_STEP_PX)
    rooms = []
    for sign, expected in ((-1.0, True), (1.0, False)):
        offsets = sign * reach[:, np.newaxis] * pixel[some, np.newaxis, np.newaxis] * samples.normals[some, np.newaxis]
        places = (samples.points[some, np.newaxis] + offsets).reshape(-1, 3)
        inside = np.isfinite(mesh.interpolate(np.ones((mesh.num_nodes, 1)), places)).reshape(len(some), -1)
        changed = inside != expected
        # Next to a curved feature the chords of the mesh are on the wrong side: the first pixels do not count.
        changed[:, :2] = False
        rooms.append(np.where(changed.any(axis=1), reach[changed.argmax(axis=1)], _FARTHEST_ROOM_PX))
    return Strip(name, samples, float(np.median(np.minimum(*rooms))))


def measure_edge(
    image: Image, camera: Placeable, strip: Strip, names: tuple[str, ...], reach: float, band: float
) -> Edge:
    """Find the edge near a projected feature.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.
    camera : FrontParallel or Pinhole
        Where the feature is thought to be.
    strip : Strip
        The feature.
    names : tuple of str
        The free parameters.
    reach : float
        How far, in pixels, the edge may be away; less where the next boundary is near.
    band : float
        Width, in pixels, of the bands beyond the reach that give the levels of the two sides.

    Returns
    -------
    Edge
        What is found; NaN where the image ends.
    """
    reach = min(reach, _ROOM * strip.room)
    band = min(band, strip.room - reach)
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
    """Return the derivatives (b, p) of the position of a feature across itself, piece by piece, by parameters."""
    slopes = pose_jacobian(camera, strip.samples.points, names)
    return strip.block_means(np.einsum("ni,nip->np", image_normals(camera, strip.samples), slopes))


def _grey_levels(image: Image, places: Floats) -> Floats:
    """Return the grey levels (n, k) at image points (n, k, 2); NaN outside the image.

    Only the part of the image around some consecutive profiles is prepared at a time.
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
    """Return ``|I - B|``, with B the level of the quieter side near each sample."""
    levels, unrest = [], []
    for side in (inner, outer):
        level = _smoothed(strip.block_means(grey[:, side].mean(axis=1)))[strip.samples.blocks]
        levels.append(level)
        unrest.append(np.nanmedian(np.abs(grey[:, side] - level[:, np.newaxis])) if np.isfinite(level).any() else 0.0)
    quiet = levels[int(np.argmin(unrest))]
    contrast: Floats = np.abs(grey - quiet[:, np.newaxis])
    return contrast


def _smoothed(values: Floats) -> Floats:
    """Return the means of values along a feature and of the two on either side of each."""
    kernel = np.ones(2 * _NEIGHBOURS + 1)
    known = np.isfinite(values)
    sums = np.convolve(np.where(known, values, 0.0), kernel, mode="full")
    counts = np.convolve(known.astype(np.float64), kernel, mode="full")
    inside = slice(_NEIGHBOURS, _NEIGHBOURS + len(values))
    with np.errstate(divide="ignore", invalid="ignore"):
        means: Floats = np.where(known, sums[inside] / counts[inside], np.nan)
    return means
