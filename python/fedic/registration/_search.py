"""A rough start brought near: the similarity of the projected features whose outline the image shows best.

The image is smoothed until speckles vanish. Across the outline of a specimen its grey level then changes, or the local
unrest that speckles leave, in the same direction all along a feature, which is what chance does not give. Translations,
turns and changes of scale of the projected features are tried on a grid, then on finer ones around the best, each on an
image smoothed and reduced half as much. The first grid is as coarse as the width of the search and the size of the
features ask for.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats, Image
from fedic.errors import SolveError
from fedic.registration._edges import Strip
from fedic.registration._pose import Placeable, move, pose_jacobian, similarity_parameters
from fedic.registration._sampling import image_normals

__all__ = ["nearby"]

_POINTS_PER_FEATURE = 48
_TURN = np.deg2rad(4.0)
_GROWTH = 0.06
_LEAST_SMOOTHING, _LAST_SMOOTHING = 6.0, 3.0
"""Of the first grid and of the last, in pixels."""
_STEP = 1.25
_OFFSET = 1.5
"""Step of a grid, and distance from a feature of the grey levels compared, in parts of the smoothing."""
_STEPS_AROUND = {"u": 3, "v": 3, "turn": 2, "growth": 2}
"""Of a finer grid, to either side of the best of the one before."""
_MOST_TRIALS = 120_000
_WIDEST_SMOOTHING = 1.0 / 3.0
"""In parts of the room around the features: what is smoothed more shows them no longer."""
_UNREST_PX = 2.0
_HALO = 8
"""Rows that this smoothing reaches."""
_ROWS_AT_ONCE = 1024
_CHUNK = 2000

Complexes: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class _Outline:
    """Some points of the projected features, as complex numbers about their centre.

    Attributes
    ----------
    arms, normals : list of ndarray
        Points, and unit vectors out of the material there, of each feature.
    centre : complex
        In the image.
    room : float
        Distance in pixels from the features to the next boundary, in the middle.
    """

    arms: list[Complexes]
    normals: list[Complexes]
    centre: complex
    room: float

    @property
    def arm(self) -> float:
        """Distance in pixels of the farthest point from the centre."""
        return float(np.abs(np.concatenate(self.arms)).max())


def nearby(
    image: Image, camera: Placeable, strips: Sequence[Strip], names: tuple[str, ...], search: float
) -> Placeable:
    """Move a camera to the best place in the neighbourhood.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.
    camera : FrontParallel or Pinhole
        The start.
    strips : sequence of Strip
        The features.
    names : tuple of str
        The free parameters; only those that move, turn and scale the image are changed.
    search : float
        Largest translation of the centre of the features, in pixels; turns go to 4 degrees and scales to 6 %.

    Returns
    -------
    FrontParallel or Pinhole
        Right to a few pixels if the specimen is where the search looks.

    Raises
    ------
    SolveError
        If the search is so wide that the features would vanish in the smoothing it takes.
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
    arms, normals = [], []
    for strip in strips:
        count = len(strip.samples.points)
        some = np.unique(np.linspace(0, count - 1, min(count, _POINTS_PER_FEATURE)).astype(int))
        arms.append(camera.project(strip.samples.points)[some] @ [1.0, 1.0j])
        normals.append(image_normals(camera, strip.samples)[some] @ [1.0, 1.0j])
    centre = complex(np.concatenate(arms).mean())
    room = float(np.median([strip.room for strip in strips]))
    return _Outline([each - centre for each in arms], normals, centre, room)


def _first_smoothing(outline: _Outline, names: tuple[str, ...], search: float) -> float:
    """Return the least smoothing whose grid is small enough to be tried.

    Raises
    ------
    SolveError
        If the features would vanish in it.
    """

    def fits(smoothing: float, reach: float) -> bool:
        counts = _counts(outline, names, reach, _STEP * smoothing)
        return math.prod(2 * count + 1 for count in counts.values()) <= _MOST_TRIALS

    smoothing = _LEAST_SMOOTHING
    while not fits(smoothing, search):
        if 2.0 * smoothing > _WIDEST_SMOOTHING * outline.room:
            largest = search
            while largest > 1.0 and not fits(smoothing, largest):
                largest *= 0.9
            raise SolveError(
                f"search={search:g}: too far to look for features that reach {outline.arm:.0f} px from their centre, "
                f"with {outline.room:.0f} px around them; steps that do not miss them are too many. Give a search up "
                f"to {largest:.2g} px and a better start, point pairs, or hold parameters with free=(...)."
            )
        smoothing *= 2.0
    return smoothing


def _counts(outline: _Outline, names: tuple[str, ...], search: float, step: float) -> dict[str, int]:
    """Return how many steps to either side a grid over the whole search has, by the names of its axes."""
    reaches = {
        "u": search if {"u0", "tx"} & set(names) else 0.0,
        "v": search if {"v0", "ty"} & set(names) else 0.0,
        "turn": _TURN * outline.arm if {"angle", "rz"} & set(names) else 0.0,
        "growth": _GROWTH * outline.arm if {"scale", "tz"} & set(names) else 0.0,
    }
    return {name: math.ceil(reach / step) for name, reach in reaches.items()}


def _candidates(outline: _Outline, counts: dict[str, int], step: float, about: Complexes) -> Complexes:
    """Return similarities ``(t, f)``, complex (n, 2): the point ``a`` about the centre goes to ``t + f a``."""
    sizes = {"u": step, "v": step, "turn": step / outline.arm, "growth": step / outline.arm}
    axes = [np.arange(-count, count + 1) * sizes[name] for name, count in counts.items()]
    u, v, turn, growth = (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij"))
    return np.column_stack([about[0] + u + 1.0j * v, about[1] * (1.0 + growth) * np.exp(1.0j * turn)])


@dataclass(frozen=True, eq=False)
class _Level:
    """The grey level and its unrest, each pixel the mean over a square of the image's."""

    channels: list[NDArray[np.float32]]
    edge: int
    smoothing: float

    def halved(self) -> "_Level":
        """Return the level of twice the smoothing."""
        return _Level([_shrunk(channel, 2) for channel in self.channels], 2 * self.edge, 2.0 * self.smoothing)

    def smoothed(self) -> list[NDArray[np.float32]]:
        """Return the channels smoothed, each divided by its spread over the image."""
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
    """Return the level of the least smoothing, a band of rows after the other."""
    import cv2

    edge = 2
    height, width = (max(size // edge, 1) for size in image.shape)
    channels = [np.empty((height, width), dtype=np.float32) for _ in range(2)]
    for first in range(0, height * edge, _ROWS_AT_ONCE):
        top = max(first - _HALO, 0)
        grey = image[top : first + _ROWS_AT_ONCE + _HALO].astype(np.float32)
        unrest = np.abs(grey - cv2.GaussianBlur(grey, (0, 0), _UNREST_PX))
        inner = slice(first - top, first - top + _ROWS_AT_ONCE)
        for channel, full in zip(channels, (grey, unrest), strict=True):
            band = channel[first // edge : (first + _ROWS_AT_ONCE) // edge]
            band[:] = _shrunk(full[inner], edge)[: len(band)]
    return _Level(channels, edge, _LAST_SMOOTHING)


def _shrunk(channel: NDArray[np.float32], factor: int) -> NDArray[np.float32]:
    """Return the means over squares; what is left over at the right and at the bottom does not count."""
    import cv2

    height, width = (max(size // factor, 1) for size in channel.shape)
    return np.asarray(
        cv2.resize(channel[: height * factor, : width * factor], (width, height), interpolation=cv2.INTER_AREA),
        dtype=np.float32,
    )


def _scores(channels: list[NDArray[np.float32]], outline: _Outline, candidates: Complexes, level: _Level) -> Floats:
    """Return for each candidate the mean changes across the features, summed without their signs."""
    height, width = channels[0].shape
    shift, factor = candidates[:, :1] + outline.centre, candidates[:, 1:]
    total = np.zeros(len(candidates))
    for arms, normals in zip(outline.arms, outline.normals, strict=True):
        places = shift + factor * arms
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
    """Return the camera whose features are where a similarity takes them, as near as its parameters allow."""
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
