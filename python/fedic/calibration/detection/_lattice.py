"""Points of a regular pattern with their integer places, and the places one line further out."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.calibration.target import Target

__all__ = ["SIDES", "Lattice", "Spots", "lattice_of"]

_NEAR_LINES = 3
_TINY = 1e-12

SIDES = ("first column", "last column", "first row", "last row")


@dataclass(frozen=True, eq=False)
class Spots:
    """Places in an image with the steps of a pattern there.

    Attributes
    ----------
    places : ndarray of int, shape (n, 2)
        Column and row in the pattern.
    pixels : ndarray, shape (n, 2)
        Image points.
    frames : ndarray, shape (n, 2, 2)
        ``frames[:, :, 0]`` and ``frames[:, :, 1]`` are one step along a row and along a column, in pixels.
    """

    places: NDArray[np.int64]
    pixels: Floats
    frames: Floats

    def moved(self, pixels: Floats) -> "Spots":
        """Return the places at other image points."""
        return Spots(self.places, pixels, self.frames)


@dataclass(frozen=True, eq=False)
class Lattice:
    """Lines of points of a pattern in an image.

    Attributes
    ----------
    places : ndarray of int, shape (n, 2)
        Column and row of each point; neighbours in a row are `stride` apart.
    pixels : ndarray, shape (n, 2)
        Image points.
    stride : int
        One, or two for asymmetric circles, whose odd rows are shifted by one.
    """

    places: NDArray[np.int64]
    pixels: Floats
    stride: int

    @cached_property
    def spots(self) -> Spots:
        """The points with the steps of the pattern."""
        return Spots(self.places, self.pixels, _steps(self._matrix, self.places))

    @property
    def misfit(self) -> float:
        """Median distance of the points from the best homography, in steps of the pattern; NaN without one."""
        steps = np.sqrt(np.abs(np.linalg.det(self.spots.frames)))
        expected = _mapped(self._matrix, self.places)
        return float(np.median(np.linalg.norm(self.pixels - expected, axis=1) / steps))

    @property
    def in_order(self) -> Floats:
        """Image points (n, 2), row by row."""
        return self.pixels[np.lexsort((self.places[:, 0], self.places[:, 1]))]

    @property
    def size(self) -> tuple[int, int]:
        """Number of columns and of rows."""
        spans = np.ptp(self.places, axis=0)
        return int(spans[0] - (self.stride > 1)) // self.stride + 1, int(spans[1]) + 1

    def beyond(self, side: str) -> Spots:
        """Return the places of the next line beyond a side, extrapolated from the three lines nearest to it."""
        axis = 0 if side.endswith("column") else 1
        sign = -1 if side.startswith("first") else 1
        wanted = self._next_column(sign) if axis == 0 else self._next_row(sign)
        border = (sign * self.places[:, axis]).max()
        reach = _NEAR_LINES * (self.stride if axis == 0 else 1)
        near = sign * self.places[:, axis] > border - reach
        return self._extrapolated(wanted, near)

    def midway(self) -> list[Spots]:
        """Return the places halfway between neighbours of a row, between neighbours of a column, and in the cells.

        A regular pattern has no points there; the cells of asymmetric circles hold a point and are left out.
        """
        known = {tuple(place): pixel for place, pixel in zip(self.places.tolist(), self.pixels, strict=True)}
        steps = [(self.stride, 0), (0, self.stride)] + ([(1, 1)] if self.stride == 1 else [])
        found = []
        spots = self.spots
        for step in steps:
            pairs = [
                (index, known[ends])
                for index, place in enumerate(self.places.tolist())
                if (ends := (place[0] + step[0], place[1] + step[1])) in known
            ]
            indices = [index for index, _ in pairs]
            middles = 0.5 * (self.pixels[indices] + np.array([pixel for _, pixel in pairs]).reshape(-1, 2))
            found.append(Spots(self.places[indices], middles, spots.frames[indices]))
        return found

    def extended(self, line: Spots) -> "Lattice":
        """Return the lattice with one more line."""
        places = np.concatenate([self.places, line.places])
        return Lattice(places, np.concatenate([self.pixels, line.pixels]), self.stride)

    @cached_property
    def _matrix(self) -> Floats:
        return _homography(self.places, self.pixels)

    def _next_column(self, sign: int) -> NDArray[np.int64]:
        rows = np.unique(self.places[:, 1])
        ends = [(sign * self.places[self.places[:, 1] == row, 0]).max() for row in rows]
        return np.array([[sign * end + sign * self.stride, row] for end, row in zip(ends, rows, strict=True)])

    def _next_row(self, sign: int) -> NDArray[np.int64]:
        border = sign * int((sign * self.places[:, 1]).max())
        model = border - sign * (self.stride - 1)  # the nearest row with the shift of the next one
        columns = np.sort(self.places[self.places[:, 1] == model, 0])
        return np.column_stack([columns, np.full_like(columns, border + sign)])

    def _extrapolated(self, wanted: NDArray[np.int64], near: NDArray[np.bool_]) -> Spots:
        """Map places by the homography of some points, corrected by the distance of the nearest one from it."""
        places, pixels = self.places[near], self.pixels[near]
        matrix = _homography(places, pixels)
        distances = np.linalg.norm(wanted[:, np.newaxis] - places, axis=2)
        corrections = (pixels - _mapped(matrix, places))[distances.argmin(axis=1)]
        return Spots(wanted, _mapped(matrix, wanted) + corrections, _steps(matrix, wanted))


def lattice_of(target: Target, pixels: Floats) -> Lattice:
    """Return the points (n, 2) of a target, row by row, as a lattice."""
    rows, columns = (index.ravel() for index in np.indices((target.rows, target.columns)))
    stride = 2 if target.kind == "asymmetric-circles" else 1
    shift = rows % 2 if stride == 2 else 0
    return Lattice(np.column_stack([stride * columns + shift, rows]).astype(np.int64), pixels, stride)


def _homography(places: NDArray[np.int64], pixels: Floats) -> Floats:
    import cv2

    matrix, _ = cv2.findHomography(places.astype(np.float64), pixels)
    return np.full((3, 3), np.nan) if matrix is None else np.asarray(matrix, dtype=np.float64)


def _mapped(matrix: Floats, places: NDArray[np.int64]) -> Floats:
    images = places @ matrix[:, :2].T + matrix[:, 2]
    mapped: Floats = images[:, :2] / np.where(np.abs(images[:, 2:]) > _TINY, images[:, 2:], np.nan)
    return mapped


def _steps(matrix: Floats, places: NDArray[np.int64]) -> Floats:
    """Return the derivatives (n, 2, 2) of the mapped points with respect to the places."""
    images = places @ matrix[:, :2].T + matrix[:, 2]
    scales = np.where(np.abs(images[:, 2]) > _TINY, images[:, 2], np.nan)[:, np.newaxis, np.newaxis]
    mapped = _mapped(matrix, places)
    steps: Floats = (matrix[np.newaxis, :2, :2] - mapped[:, :, np.newaxis] * matrix[np.newaxis, 2:, :2]) / scales
    return steps
