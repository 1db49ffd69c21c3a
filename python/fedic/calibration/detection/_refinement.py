"""Points of a target refined in its plane, once the camera is nearly known."""

import numpy as np

from fedic._core import Pinhole
from fedic._internal.types import Floats, Image
from fedic.calibration.detection._circles import centre_in_plane, centre_reach
from fedic.calibration.detection._corners import corner_in_plane, corner_reach
from fedic.calibration.observation import Observation
from fedic.calibration.target import Target
from fedic.errors import CameraError

__all__ = ["refined"]

_FARTHEST_PX = 2.0


def refined(image: Image, target: Target, seen: Observation, camera: Pinhole) -> Observation:
    """Return an observation with its points measured in the plane of the target.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The view.
    target : Target
        What it shows.
    seen : Observation
        Where its points were found.
    camera : Pinhole
        Camera with the pose of this view, right to a pixel or so.

    Returns
    -------
    Observation
        The points refined. One that cannot be, or would move by over 2 px, is left out; if that is more than half, the
        observation stays as it was.
    """
    of_circles = target.kind in ("circles", "asymmetric-circles")
    reach = centre_reach(target) if of_circles else corner_reach(target)
    grey = np.asarray(image, dtype=np.float64)
    try:
        starts = camera.unproject(seen.pixels)[:, :2]
    except CameraError:
        return seen
    found = np.full_like(starts, np.nan)
    for index, start in enumerate(starts):
        window = _window(grey, camera, start, reach, whole=of_circles)
        if window is None:
            continue
        points, levels, areas = window
        if of_circles:
            found[index] = centre_in_plane(points, levels, areas, start, reach)
        else:
            found[index] = corner_in_plane(points, levels, start, reach, float(np.sqrt(np.median(areas))))
    pixels = camera.project(found)
    good = np.linalg.norm(pixels - seen.pixels, axis=1) <= _FARTHEST_PX
    if good.sum() < 0.5 * len(good):
        return seen
    return Observation(seen.points[good], pixels[good])


def _window(
    grey: Floats, camera: Pinhole, centre: Floats, reach: float, *, whole: bool
) -> tuple[Floats, Floats, Floats] | None:
    """Return the pixels around a point of the plane: positions and areas in the plane, and levels.

    None if nothing of it is in the image, or, where it is wanted whole, some part is not.
    """
    ends = reach * np.array([-1.1, 0.0, 1.1])
    border = camera.project(centre + np.stack(np.meshgrid(ends, ends), axis=-1).reshape(-1, 2))
    if not np.isfinite(border).all():
        return None
    left, top = np.floor(border.min(axis=0)).astype(int)
    right, bottom = np.ceil(border.max(axis=0)).astype(int) + 1
    limits = max(left, 0), max(top, 0), min(right, grey.shape[1]), min(bottom, grey.shape[0])
    if whole and limits != (left, top, right, bottom):
        return None
    left, top, right, bottom = limits
    if left >= right or top >= bottom:
        return None
    row, column = np.indices((bottom - top, right - left))
    try:
        points = camera.unproject(np.column_stack([column.ravel() + left, row.ravel() + top]).astype(np.float64))
    except CameraError:
        return None
    slopes = camera.jacobian(points)[:, :, :2]
    areas = 1.0 / np.abs(slopes[:, 0, 0] * slopes[:, 1, 1] - slopes[:, 0, 1] * slopes[:, 1, 0])
    return points[:, :2], grey[top:bottom, left:right].ravel(), areas
