"""Refinement of the points of a target in its plane, once an approximate camera is known."""

from dataclasses import dataclass

import numpy as np

from fedic._core import Pinhole
from fedic._internal.types import Floats, Image
from fedic.calibration.detection._circles import centre_in_plane, centre_reach
from fedic.calibration.detection._corners import corner_in_plane, corner_reach
from fedic.calibration.observation import Observation
from fedic.calibration.target import Target
from fedic.errors import CameraError

__all__ = ["refine_points"]

_FARTHEST_PX = 2.0


@dataclass(frozen=True, eq=False)
class _Window:
    """Pixels around a target point: image points (n, 2) and grey levels (n,)."""

    pixels: Floats
    levels: Floats


def refine_points(image: Image, target: Target, seen: Observation, camera: Pinhole) -> Observation:
    """Measure the points of an observation again in the plane of the target.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The view.
    target : Target
        The target.
    seen : Observation
        Points found in the view.
    camera : Pinhole
        Camera with the pose of this view, right to about a pixel.

    Returns
    -------
    Observation
        The refined points. Points that cannot be refined, or would move by over 2 px, are left out; if these are more
        than half, the observation is returned unchanged.
    """
    of_circles = target.kind in ("circles", "asymmetric-circles", "ring-dots")
    reach = centre_reach(target) if of_circles else corner_reach(target)
    try:
        starts = camera.unproject(seen.pixels)[:, :2]
    except CameraError:
        return seen
    around = _windows(np.asarray(image, dtype=np.float64), camera, starts, reach, whole=of_circles)
    windows = {index: window for index, window in enumerate(around) if window is not None}
    unprojected = _unprojected(camera, list(windows.values()))
    found = np.full_like(starts, np.nan)
    for (index, window), points in zip(windows.items(), unprojected, strict=True):
        if points is None:
            continue
        slopes = camera.jacobian(points)[:, :, :2]
        areas = 1.0 / np.abs(slopes[:, 0, 0] * slopes[:, 1, 1] - slopes[:, 0, 1] * slopes[:, 1, 0])
        if of_circles:
            found[index] = centre_in_plane(points[:, :2], window.levels, areas, starts[index], reach)
        else:
            pixel = float(np.sqrt(np.median(areas)))
            found[index] = corner_in_plane(points[:, :2], window.levels, starts[index], reach, pixel)
    pixels = camera.project(found)
    good = np.linalg.norm(pixels - seen.pixels, axis=1) <= _FARTHEST_PX
    if good.sum() < 0.5 * len(good):
        return seen
    return Observation(seen.points[good], pixels[good])


def _windows(grey: Floats, camera: Pinhole, centres: Floats, reach: float, *, whole: bool) -> list[_Window | None]:
    """Return the pixels around points (n, 2) of the plane.

    None for a point that is outside the image, or, with `whole`, whose window is not completely inside.
    """
    ends = reach * np.array([-1.1, 0.0, 1.1])
    grid = np.stack(np.meshgrid(ends, ends), axis=-1).reshape(-1, 2)
    borders = camera.project((centres[:, np.newaxis] + grid).reshape(-1, 2)).reshape(len(centres), -1, 2)
    windows: list[_Window | None] = []
    for border in borders:
        if not np.isfinite(border).all():
            windows.append(None)
            continue
        left, top = np.floor(border.min(axis=0)).astype(int)
        right, bottom = np.ceil(border.max(axis=0)).astype(int) + 1
        limits = max(left, 0), max(top, 0), min(right, grey.shape[1]), min(bottom, grey.shape[0])
        empty = limits[0] >= limits[2] or limits[1] >= limits[3]
        if empty or (whole and limits != (left, top, right, bottom)):
            windows.append(None)
            continue
        left, top, right, bottom = limits
        row, column = np.indices((bottom - top, right - left))
        pixels = np.column_stack([column.ravel() + left, row.ravel() + top]).astype(np.float64)
        windows.append(_Window(pixels, grey[top:bottom, left:right].ravel()))
    return windows


def _unprojected(camera: Pinhole, windows: list[_Window]) -> list[Floats | None]:
    """Return the points (n, 3) of each window, unprojected together; None for windows that have none in the plane."""
    if not windows:
        return []
    try:
        points = camera.unproject(np.concatenate([window.pixels for window in windows]))
    except CameraError:
        if len(windows) == 1:
            return [None]
        half = len(windows) // 2
        return _unprojected(camera, windows[:half]) + _unprojected(camera, windows[half:])
    return list(np.split(points, np.cumsum([len(window.pixels) for window in windows])[:-1]))
