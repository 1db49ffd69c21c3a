"""Coarse search for the similarity that brings the projected features onto edges of the image.

The image is smoothed until speckles vanish. Across the outline of a specimen the grey level then changes, or the local
contrast that speckles leave, with the same sign all along a feature, which rarely happens by chance. Translations,
rotations and changes of scale of the projected features are tried on a grid, then on finer grids around the best, each
on an image smoothed and reduced half as much. The spacing of the first grid follows from the width of the search and
the size of the features.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats, Image
from fedic.errors import OptionError
from fedic.registration._edges import Strip
from fedic.registration._pose import Placeable, move, pose_jacobian, similarity_parameters
from fedic.registration._sampling import image_normals

__all__ = ["nearby"]

_POINTS_PER_FEATURE = 48
_ROTATION = np.deg2rad(4.0)
_SCALE = 0.06
_LEAST_SMOOTHING, _LAST_SMOOTHING = 6.0, 3.0
"""Smallest smoothing of the first grid, and smoothing of the last, in pixels."""
_STEP = 1.25
_OFFSET = 1.5
"""Step of a grid, and distance from a feature of the grey levels compared, relative to the smoothing."""
_STEPS_AROUND = {"u": 3, "v": 3, "rotation": 2, "scale": 2}
"""Number of steps of a finer grid to either side of the best point of the previous one."""
_MOST_TRIALS = 120_000
_WIDEST_SMOOTHING = 1.0 / 3.0
"""Largest smoothing, relative to the clearance of the features, that does not blur them away."""
_CONTRAST_PX = 2.0
"""Smoothing whose difference from the image is the local contrast."""
_HALO = 8
"""Support of this smoothing, in rows."""
_ROWS_AT_ONCE = 1024
_CHUNK = 2000

Complexes: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class _Outline:
    """Some points of the projected features, as complex numbers about their centre.

    Attributes
    ----------
    offsets, normals : list of ndarray
        Points of each feature, and unit vectors out of the material there.
    centre : complex
        Centre in the image.
    clearance : float
        Median distance in pixels from the features to the next boundary.
    """

    offsets: list[Complexes]
    normals: list[Complexes]
    centre: complex
    clearance: float

    @property
    def radius(self) -> float:
        """Distance in pixels of the farthest point from the centre."""
        return float(np.abs(np.concatenate(self.offsets)).max())


def nearby(
    image: Image, camera: Placeable, strips: Sequence[Strip], names: tuple[str, ...], search: float
) -> Placeable:
    """Find the best similarity in the neighbourhood of a camera.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.
    camera : FrontParallel or Pinhole
        The start.
    strips : sequence of Strip
        The features.
    names : tuple of str
        The free parameters; only those that translate, rotate and scale the image are changed.
    search : float
        Largest translation of the centre of the features in pixels; rotations go to 4 degrees and scales to 6 %.

    Returns
    -------
    FrontParallel or Pinhole
        Camera right to a few pixels, if the specimen is within the search.

    Raises
    ------
    OptionError
        If the search is so wide that the smoothing it needs would blur the features away.
    """
    names = similarity_parameters(names)
    if not names or search <= 0.0:
        return camera
    outline = _outline(camera, strips)
    smoothing = _first_smoothing(outline, names, search)
    levels = [_reduced(image)]
    while levels[-1].smoothing < smoothing:
        levels.append(levels[-1].halved())
    best = np.array([0.0 + 0.0j, 1.0 + 0.0j])
    while levels:
        level = levels.pop()
        step = _STEP * level.smoothing
        counts = _counts(outline, names, search, step)
        if level.smoothing < smoothing:
            counts = {name: min(count, _STEPS_AROUND[name]) for name, count in counts.items()}
        candidates = _candidates(outline, counts, step, best)
        channels = level.smoothed()
        scores = np.concatenate(
            [
                _scores(channels, outline, candidates[first : first + _CHUNK], level)
                for first in range(0, len(candidates), _CHUNK)
            ]
        )
        best = candidates[int(np.argmax(scores))]
    return _moved(camera, strips, names, outline.centre, best)


def _outline(camera: Placeable, strips: Sequence[Strip]) -> _Outline:
    positions, normals = [], []
    for strip in strips:
        count = len(strip.samples.points)
        some = np.unique(np.linspace(0, count - 1, min(count, _POINTS_PER_FEATURE)).astype(int))
        positions.append(camera.project(strip.samples.points)[some] @ [1.0, 1.0j])
        normals.append(image_normals(camera, strip.samples)[some] @ [1.0, 1.0j])
    centre = complex(np.concatenate(positions).mean())
    clearance = float(np.median([strip.clearance for strip in strips]))
    return _Outline([each - centre for each in positions], normals, centre, clearance)


def _first_smoothing(outline: _Outline, names: tuple[str, ...], search: float) -> float:
    """Return the smallest smoothing whose grid has few enough points.

    Raises
    ------
    OptionError
        If it would blur the features away.
    """

    def fits(smoothing: float, reach: float) -> bool:
        counts = _counts(outline, names, reach, _STEP * smoothing)
        return math.prod(2 * count + 1 for count in counts.values()) <= _MOST_TRIALS

    smoothing = _LEAST_SMOOTHING
    while not fits(smoothing, search):
        if 2.0 * smoothing > _WIDEST_SMOOTHING * outline.clearance:
            largest = search
            while largest > 1.0 and not fits(smoothing, largest):
                largest *= 0.9
            raise OptionError(
                f"search={search:g}: too wide for features that extend {outline.radius:.0f} px from their centre with "
                f"{outline.clearance:.0f} px around them; a grid fine enough has too many points. Give a search up to "
                f"{largest:.2g} px and a better start, point pairs, or hold parameters with free=(...).",
                "search",
            )
        smoothing *= 2.0
    return smoothing


def _counts(outline: _Outline, names: tuple[str, ...], search: float, step: float) -> dict[str, int]:
    """Return the numbers of steps to either side of a grid over the whole search, by the names of its axes."""
    reaches = {
        "u": search if {"u0", "tx"} & set(names) else 0.0,
        "v": search if {"v0", "ty"} & set(names) else 0.0,
        "rotation": _ROTATION * outline.radius if {"angle", "rz"} & set(names) else 0.0,
        "scale": _SCALE * outline.radius if {"scale", "tz"} & set(names) else 0.0,
    }
    return {name: math.ceil(reach / step) for name, reach in reaches.items()}


def _candidates(outline: _Outline, counts: dict[str, int], step: float, about: Complexes) -> Complexes:
    """Return similarities ``(t, f)``, complex (n, 2), which map the offset ``a`` from the centre to ``t + f a``."""
    sizes = {"u": step, "v": step, "rotation": step / outline.radius, "scale": step / outline.radius}
    axes = [np.arange(-count, count + 1) * sizes[name] for name, count in counts.items()]
    u, v, rotation, scale = (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij"))
    return np.column_stack([about[0] + u + 1.0j * v, about[1] * (1.0 + scale) * np.exp(1.0j * rotation)])


@dataclass(frozen=True, eq=False)
class _Level:
    """Grey level and local contrast of an image, reduced by the mean over squares of pixels."""

    channels: list[NDArray[np.float32]]
    edge: int
    smoothing: float

    def halved(self) -> "_Level":
        """Return the level reduced once more, with twice the smoothing."""
        return _Level([_shrunk(channel, 2) for channel in self.channels], 2 * self.edge, 2.0 * self.smoothing)

    def smoothed(self) -> list[NDArray[np.float32]]:
        """Return the channels smoothed, each divided by its standard deviation over the image."""
        import cv2

        channels = []
        for channel in self.channels:
            smooth: NDArray[np.float32] = np.asarray(cv2.GaussianBlur(channel, (0, 0), self.smoothing / self.edge))
            smooth /= max(float(cv2.meanStdDev(smooth)[1].item()), 1e-12)
            channels.append(smooth)
        return channels

    def index(self, places: Complexes) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the rows and columns of the pixels nearest to image points."""
        corner = 0.5 * (self.edge - 1)
        rows, columns = (np.rint((part - corner) / self.edge).astype(np.int64) for part in (places.imag, places.real))
        return rows, columns


def _reduced(image: Image) -> _Level:
    """Return the level of the smallest smoothing, computed by bands of rows."""
    import cv2

    edge = 2
    height, width = (max(size // edge, 1) for size in image.shape)
    channels = [np.empty((height, width), dtype=np.float32) for _ in range(2)]
    for first in range(0, height * edge, _ROWS_AT_ONCE):
        top = max(first - _HALO, 0)
        grey = image[top : first + _ROWS_AT_ONCE + _HALO].astype(np.float32)
        contrast = np.abs(grey - cv2.GaussianBlur(grey, (0, 0), _CONTRAST_PX))
        inner = slice(first - top, first - top + _ROWS_AT_ONCE)
        for channel, full in zip(channels, (grey, contrast), strict=True):
            band = channel[first // edge : (first + _ROWS_AT_ONCE) // edge]
            band[:] = _shrunk(full[inner], edge)[: len(band)]
    return _Level(channels, edge, _LAST_SMOOTHING)


def _shrunk(channel: NDArray[np.float32], factor: int) -> NDArray[np.float32]:
    """Return the means over squares; incomplete squares at the right and at the bottom are left out."""
    import cv2

    height, width = (max(size // factor, 1) for size in channel.shape)
    return np.asarray(
        cv2.resize(channel[: height * factor, : width * factor], (width, height), interpolation=cv2.INTER_AREA),
        dtype=np.float32,
    )


def _scores(channels: list[NDArray[np.float32]], outline: _Outline, candidates: Complexes, level: _Level) -> Floats:
    """Return for each candidate the sum of the absolute mean changes across the features."""
    height, width = channels[0].shape
    shift, factor = candidates[:, :1] + outline.centre, candidates[:, 1:]
    total = np.zeros(len(candidates))
    for offsets, normals in zip(outline.offsets, outline.normals, strict=True):
        places = shift + factor * offsets
        across = _OFFSET * level.smoothing * normals * (factor / np.abs(factor))
        inner, outer = level.index(places - across), level.index(places + across)
        seen = np.ones(places.shape, dtype=bool)
        for rows, columns in (inner, outer):
            seen &= (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
            np.clip(rows, 0, height - 1, out=rows)
            np.clip(columns, 0, width - 1, out=columns)
        for channel in channels:
            changes = np.where(seen, channel[inner] - channel[outer], 0.0)
            total += np.abs(changes.mean(axis=1))
    return total


def _moved(
    camera: Placeable, strips: Sequence[Strip], names: tuple[str, ...], centre: complex, similarity: Complexes
) -> Placeable:
    """Return the camera that projects the features as near as possible to their images under a similarity."""
    points = np.concatenate([strip.samples.points for strip in strips])
    places = camera.project(points) @ [1.0, 1.0j]
    wanted = centre + similarity[0] + similarity[1] * (places - centre)
    targets = np.column_stack([wanted.real, wanted.imag])
    for _ in range(4):
        rows = pose_jacobian(camera, points, names).reshape(-1, len(names))
        scale = np.linalg.norm(rows, axis=0)
        away = (targets - camera.project(points)).ravel()
        camera = move(camera, names, np.linalg.lstsq(rows / scale, away, rcond=1e-6)[0] / scale)
    return camera
