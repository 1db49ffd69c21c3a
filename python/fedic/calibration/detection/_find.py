"""Detection of the points of a target in an image, to a fraction of a pixel."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats, Image
from fedic.calibration.detection._count import grown_pattern, is_pattern, trimmed
from fedic.calibration.detection._lattice import lattice_of
from fedic.calibration.detection._rings import find_rings
from fedic.calibration.observation import Observation
from fedic.calibration.target import Target

__all__ = ["NotFoundError", "WrongCountError", "find_target"]

_SMALLEST_BLOB = 12.0
_FEWEST_POINTS = 6


class NotFoundError(Exception):
    """The target is not in the image; the message names the likely cause."""


class WrongCountError(NotFoundError):
    """The image shows the pattern with more or fewer points than the target has."""


def find_target(image: Image, target: Target) -> Observation:
    """Find the points of a target in an image.

    Chessboards are detected by the Radon transform of Duda and Frese (2018), ChArUco boards by their markers, circles
    and dots as blobs, whose centres `refine_points` corrects once an approximate camera is known.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        Grey levels.
    target : Target
        Target to find.

    Returns
    -------
    Observation
        All points of the target; of a ChArUco board and of dots with rings those in view.

    Raises
    ------
    NotFoundError
        If the target is not in the image.
    """
    import cv2

    cv2.setRNGSeed(0)  # the searches use OpenCV's random generator; results must be reproducible
    grey = _eight_bits(image)
    if target.kind in ("charuco", "ring-dots"):
        return _find_charuco(grey, target) if target.kind == "charuco" else _find_ring_dots(grey, target)
    pixels = _find_chessboard(grey, target) if target.kind == "chessboard" else _find_circles(grey, target)
    return Observation(target.points, pixels)


def _eight_bits(image: Image) -> NDArray[np.uint8]:
    if image.dtype == np.uint8:
        return image  # type: ignore[return-value]
    low, high = float(image.min()), float(image.max())
    return np.rint((image.astype(np.float64) - low) * (255.0 / max(high - low, 1e-30))).astype(np.uint8)


def _find_chessboard(grey: NDArray[np.uint8], target: Target) -> Floats:
    """Find the corners by three searches, each checked: none finds every board, and each may find wrong corners."""
    import cv2

    size = target.columns, target.rows
    flags = cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY
    found, corners = cv2.findChessboardCornersSB(grey, size, flags=flags)
    if found and is_pattern(grey, target, pixels := _from_the_front(corners, target)):
        return _whole(grey, target, pixels)
    larger = cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_LARGER
    seen, corners, layout = cv2.findChessboardCornersSBWithMeta(grey, (3, 3), larger)
    if seen:
        grid = trimmed(grey, np.asarray(corners, dtype=np.float64).reshape(*layout.shape[:2], 2))
        if (grid.shape[0] > grid.shape[1]) != (target.rows > target.columns):
            grid = grid.transpose(1, 0, 2)
        other = replace(target, columns=grid.shape[1], rows=grid.shape[0])
        pixels = _from_the_front(grid, other)
        if is_pattern(grey, other, pixels):
            grown = grown_pattern(grey, other, pixels)
            if grown.size == size:
                return grown.in_order
            raise _another_count(target, grown.size)
    found, corners = cv2.findChessboardCorners(grey, size, flags=cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_FAST_CHECK)
    if found and is_pattern(grey, target, pixels := _from_the_front(corners, target)):
        return _whole(grey, target, pixels)
    raise NotFoundError(f"no complete chessboard of {target.columns} x {target.rows} inner corners is found")


def _another_count(target: Target, seen: tuple[int, int]) -> NotFoundError:
    """Return the fault of a chessboard that is seen with other counts: fewer corners may be a part of it."""
    own = target.columns, target.rows
    columns, rows = sorted(seen, reverse=own[0] >= own[1])
    said = f"a chessboard of {columns} x {rows} inner corners is found, {own[0]} x {own[1]} were expected"
    more = max(seen) > max(own) or min(seen) > min(own)
    return (
        WrongCountError(said) if more else NotFoundError(f"{said}: a part of it is not in view, or the count is wrong")
    )


def _whole(grey: NDArray[np.uint8], target: Target, pixels: Floats) -> Floats:
    """Return the points found if the pattern does not go on beyond them."""
    columns, rows = grown_pattern(grey, target, pixels).size
    if (columns, rows) == (target.columns, target.rows):
        return pixels
    what = "inner corners" if target.kind == "chessboard" else "circles"
    raise WrongCountError(
        f"the pattern goes on beyond {target.columns} x {target.rows} {what}: at least {columns} x {rows} are seen"
    )


def _find_circles(grey: NDArray[np.uint8], target: Target) -> Floats:
    """Find dark circles, or light ones in the inverted image."""
    import cv2

    blobs: Any = cv2  # the stubs lack SimpleBlobDetector
    options = blobs.SimpleBlobDetector_Params()
    options.minArea = _SMALLEST_BLOB
    options.maxArea = grey.size / (target.columns * target.rows)
    options.minDistBetweenBlobs = 3.0
    detector = blobs.SimpleBlobDetector_create(options)
    layout = cv2.CALIB_CB_SYMMETRIC_GRID if target.kind == "circles" else cv2.CALIB_CB_ASYMMETRIC_GRID
    for picture in (grey, 255 - grey):
        for clustering in (0, cv2.CALIB_CB_CLUSTERING):
            size = (target.columns, target.rows)
            found, centres = cv2.findCirclesGrid(picture, size, flags=layout | clustering, blobDetector=detector)
            if not found:
                continue
            pixels = _from_the_front(_rows_in_order(centres, target), target)
            if is_pattern(grey, target, pixels):
                return _whole(grey, target, pixels)
    count = max(len(detector.detect(grey)), len(detector.detect(255 - grey)))
    raise NotFoundError(
        f"no complete grid of {target.columns} x {target.rows} circles is found; the image has {count} blobs"
    )


def _rows_in_order(centres: Any, target: Target) -> Floats:
    """Return circles in the order of the rows: OpenCV may swap each two rows of an even number of shifted ones."""
    grid = np.asarray(centres, dtype=np.float64).reshape(target.rows, target.columns, 2)
    if target.kind != "asymmetric-circles" or target.rows % 2:
        return grid
    swapped = grid.reshape(-1, 2, target.columns, 2)[:, ::-1].reshape(grid.shape)
    return min((grid, swapped), key=lambda each: lattice_of(target, _from_the_front(each, target)).misfit)


def _find_charuco(grey: NDArray[np.uint8], target: Target) -> Observation:
    import cv2

    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, target.dictionary))
    best: NDArray[Any] = np.empty(0, dtype=np.int64)
    markers = 0
    corners: Any = None
    for legacy in (False, True):
        board = cv2.aruco.CharucoBoard((target.columns, target.rows), target.pitches[0], target.marker, dictionary)
        board.setLegacyPattern(legacy)
        found, numbers, _, seen = cv2.aruco.CharucoDetector(board).detectBoard(grey)
        markers = max(markers, 0 if seen is None else len(seen))
        if numbers is not None and len(numbers) > len(best):
            best, corners = numbers.ravel(), found.reshape(-1, 2)
    points = target.points[best]
    if (
        len(best) < _FEWEST_POINTS
        or np.linalg.matrix_rank(points - points.mean(axis=0), tol=min(target.pitches) / 2) < 2
    ):
        raise NotFoundError(
            f"{len(best)} corners of the board are found, where at least {_FEWEST_POINTS}, not collinear, are needed, "
            f"and {markers} markers of {target.dictionary}"
        )
    return Observation(points, np.asarray(corners, dtype=np.float64))


def _find_ring_dots(grey: NDArray[np.uint8], target: Target) -> Observation:
    found = find_rings(grey, target)
    if found.beyond is not None:
        raise WrongCountError(
            f"the dots go on beyond the {found.beyond} of {target.columns} x {target.rows} dots with the ring of the "
            f"origin {target.origin[0]} from the left and {target.origin[1]} from below"
        )
    if len(found.places) < _FEWEST_POINTS:
        raise NotFoundError(
            f"the three rings of the target are not found {target.axes[0]} steps apart along X and {target.axes[1]} "
            f"along Y; {found.rings} rings are seen in the image"
        )
    points = np.column_stack([found.places * target.pitches, np.zeros(len(found.places))])
    return Observation(points, found.pixels)


def _from_the_front(found: Any, target: Target) -> Floats:
    """Return points (n, 2), with the rows reversed if they were read as if the target were seen from behind."""
    grid = np.asarray(found, dtype=np.float64).reshape(target.rows, target.columns, 2)
    row, column = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
    from_the_front = row[0] * column[1] - row[1] * column[0] > 0.0
    return (grid if from_the_front else grid[::-1]).reshape(-1, 2)
