"""Detection of a grid of dots of which three are rings: the origin and one on each axis. A part of it may be seen.

Dots are outlines that an ellipse fits; rings are dots with a hole. Each choice of three rings for the origin and the
axes gives two steps; from the origin on, the dots are numbered outwards, each from its neighbours found before. The
choice is right if the numbers of the other two rings come out as planned.
"""

from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.calibration.target import Target

__all__ = ["RingGrid", "find_rings"]

_SMALLEST_AREA = 12.0
_FLATTEST = 0.25
_LARGEST_AREA = 0.02
_LEAST_FILLED, _MOST_FILLED = 0.93, 1.07
_HOLE = (0.04, 0.8)
_OFF_CENTRE = 0.2
_MOST_RINGS = 12
_REACH = 0.3
_SIZES = (0.4, 2.5)
_FEWEST_BEYOND = 3
_MOST_OF_LINE = 0.65
_OFF_PATTERN = 0.2
_WINDOWS = (0.05, 0.12, 0.3)
"""Sides of the windows of the adaptive thresholds, relative to the image."""


@dataclass(frozen=True, eq=False)
class RingGrid:
    """Dots found in an image.

    Attributes
    ----------
    places : ndarray of int, shape (n, 2)
        Column and row of each dot, counted from the origin ring along X and Y.
    pixels : ndarray, shape (n, 2)
        Centres of their images.
    rings : int
        Number of rings seen.
    beyond : str or None
        Side of the target, such as ``"first row"``, beyond which the dots go on.
    """

    places: NDArray[np.int64]
    pixels: Floats
    rings: int
    beyond: str | None = None


@dataclass(frozen=True, eq=False)
class _Dots:
    """Centres (n, 2), areas (n,) and which have a hole (n,)."""

    centres: Floats
    areas: Floats
    hollow: NDArray[np.bool_]


def find_rings(grey: NDArray[np.uint8], target: Target) -> RingGrid:
    """Find the dots of a target with three rings.

    Parameters
    ----------
    grey : ndarray, shape (height, width)
        The image.
    target : Target
        The target.

    Returns
    -------
    RingGrid
        The dots; none if the three rings are not found.
    """
    best = RingGrid(np.empty((0, 2), dtype=np.int64), np.empty((0, 2)), 0)
    for picture in (grey, 255 - grey):
        for window in _WINDOWS:
            dots = _dots(picture, window)
            rings = np.flatnonzero(dots.hollow)
            rings = rings[np.argsort(-dots.areas[rings])][:_MOST_RINGS]
            best = RingGrid(best.places, best.pixels, max(best.rings, len(rings)))
            for chosen in permutations(rings.tolist(), 3):
                numbers = _numbered(dots, chosen, target)
                if len(numbers) > len(best.places):
                    places = np.array(list(numbers), dtype=np.int64)
                    best = RingGrid(places, dots.centres[list(numbers.values())], best.rings)
    return _within(best, target)


def _within(found: RingGrid, target: Target) -> RingGrid:
    """Leave out the dots beyond the border and those off the pattern; tell whether a line beyond the border is seen."""
    import cv2

    places = found.places + target.origin
    last = np.array([target.columns - 1, target.rows - 1])
    beyond = None
    for axis, name in ((0, "column"), (1, "row")):
        for side, border, out in (("first", 0, -1), ("last", last[axis], last[axis] + 1)):
            seen, outside = (places[:, axis] == border).sum(), (places[:, axis] == out).sum()
            if outside >= max(_FEWEST_BEYOND, _MOST_OF_LINE * seen):
                beyond = f"{side} {name}"
    kept: NDArray[np.bool_] = np.asarray(((places >= 0) & (places <= last)).all(axis=1))
    if kept.sum() > 4:
        step = np.median(np.ptp(found.pixels, axis=0) / np.maximum(np.ptp(places, axis=0), 1))
        _, fits = cv2.findHomography(
            places[kept].astype(np.float64), found.pixels[kept], cv2.RANSAC, _OFF_PATTERN * float(step)
        )
        kept[kept] = fits.ravel().astype(bool) if fits is not None else False
    return RingGrid(found.places[kept], found.pixels[kept], found.rings, beyond)


def _dots(picture: NDArray[np.uint8], window: float) -> _Dots:
    """Return the dark outlines that an ellipse fits."""
    import cv2

    side = max(int(window * min(picture.shape)) | 1, 11)
    smooth = cv2.GaussianBlur(picture, (3, 3), 0)
    dark = cv2.adaptiveThreshold(smooth, 255, cv2.ADAPTIVE_THRESH_MEAN_C, cv2.THRESH_BINARY_INV, side, 7)
    outlines, tree = cv2.findContours(dark, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    centres, areas, hollow = [], [], []
    for index, outline in enumerate(outlines):
        if tree[0][index][3] >= 0 or _cut(outline, picture) or (shape := _ellipse(outline, picture.size)) is None:
            continue
        centre, area = shape
        child, is_ring = tree[0][index][2], False
        while child >= 0:
            hole = _ellipse(outlines[child], picture.size)
            if hole is not None and _HOLE[0] < hole[1] / area < _HOLE[1]:
                is_centred = bool(np.linalg.norm(hole[0] - centre) < _OFF_CENTRE * np.sqrt(area))
                is_ring |= is_centred and _is_light(smooth, outline, centre)
            child = tree[0][child][0]
        centres.append(centre)
        areas.append(area)
        hollow.append(is_ring)
    return _Dots(np.array(centres).reshape(-1, 2), np.array(areas), np.array(hollow, dtype=bool))


def _cut(outline: NDArray[Any], picture: NDArray[Any]) -> bool:
    """Tell whether an outline touches the border of the image, which may cut the dot."""
    low, high = outline.min(axis=(0, 1)), outline.max(axis=(0, 1))
    return bool((low <= 1).any() or (high >= np.array(picture.shape[::-1]) - 2).any())


def _is_light(picture: NDArray[Any], outline: NDArray[Any], centre: Floats) -> bool:
    """Tell whether the centre of an outline is nearer to the levels outside than to the ink."""
    low, high = outline.min(axis=(0, 1)) - 2, outline.max(axis=(0, 1)) + 3
    box = picture[max(low[1], 0) : high[1], max(low[0], 0) : high[0]]
    ink, ground = np.percentile(box, [10.0, 90.0])
    column, row = np.rint(centre).astype(int)
    return bool(2.0 * picture[row, column] > ink + ground)


def _ellipse(outline: NDArray[Any], size: int) -> tuple[Floats, float] | None:
    """Return centre and area of an outline if an ellipse fits it."""
    import cv2

    if len(outline) < 8:
        return None
    enclosed = cv2.contourArea(outline) + 0.5 * len(outline)
    if not _SMALLEST_AREA <= enclosed <= _LARGEST_AREA * size:
        return None
    centre, axes, _ = cv2.fitEllipse(outline)
    area = 0.25 * np.pi * (axes[0] + 1.0) * (axes[1] + 1.0)
    if min(axes) < _FLATTEST * max(axes) or not _LEAST_FILLED < enclosed / area < _MOST_FILLED:
        return None
    return np.array(centre, dtype=np.float64), float(area)


def _numbered(dots: _Dots, rings: tuple[int, ...], target: Target) -> dict[tuple[int, int], int]:
    """Return the dots by column and row from the origin; empty unless the other rings get their numbers."""
    origin, along_x, along_y = rings
    x_count, y_count = target.axes
    start = dots.centres[origin]
    steps = np.array([(dots.centres[along_x] - start) / x_count, (dots.centres[along_y] - start) / y_count])
    if np.linalg.det(steps) >= 0.0:  # Y is up, and the rows of the image go down
        return {}
    numbers, frames = {(0, 0): origin}, {(0, 0): steps}
    taken, queue = {origin}, [(0, 0)]
    while queue:
        place = queue.pop(0)
        for axis, sign in ((0, 1), (0, -1), (1, 1), (1, -1)):
            next_place = (place[0] + sign * (axis == 0), place[1] + sign * (axis == 1))
            if next_place in numbers or not _on_target(next_place, target):
                continue
            step = sign * frames[place][axis]
            distances = np.linalg.norm(dots.centres - dots.centres[numbers[place]] - step, axis=1)
            nearest = int(distances.argmin())
            ratio = dots.areas[nearest] / dots.areas[numbers[place]]
            if (
                nearest in taken
                or distances[nearest] > _REACH * np.linalg.norm(step)
                or not _SIZES[0] < ratio < _SIZES[1]
            ):
                continue
            numbers[next_place] = nearest
            taken.add(nearest)
            frame = frames[place].copy()
            frame[axis] = sign * (dots.centres[nearest] - dots.centres[numbers[place]])
            frames[next_place] = frame
            queue.append(next_place)
    right = numbers.get((x_count, 0)) == along_x and numbers.get((0, y_count)) == along_y
    return numbers if right else {}


def _on_target(place: tuple[int, int], target: Target) -> bool:
    """Tell whether a place is on the target or on the line next to its border, where wrong counts show."""
    column, row = place[0] + target.origin[0], place[1] + target.origin[1]
    return -1 <= column <= target.columns and -1 <= row <= target.rows
