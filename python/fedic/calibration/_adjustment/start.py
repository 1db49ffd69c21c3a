"""Initial estimate: focal length from the homographies, no distortion, each pose from its own view."""

import numpy as np

from fedic._internal.types import Floats
from fedic.calibration._adjustment.bundle import Estimate
from fedic.calibration.lenses import Lens
from fedic.calibration.observation import Observation
from fedic.cameras.poses import flat_poses
from fedic.errors import CameraError

__all__ = ["FOCAL_RANGE", "initial_estimate", "pose_of"]

FOCAL_RANGE = (0.2, 100.0)
"""Plausible focal lengths relative to the longer side of the image; a start outside takes their geometric mean."""
_LINE = 1e-3
"""Ratio of width to length below which points are collinear."""


def initial_estimate(lens: Lens, observations: list[Observation], image_size: tuple[int, int]) -> Estimate:
    """Return the initial estimate of a fit.

    Parameters
    ----------
    lens : Lens
        Lens model.
    observations : list of Observation
        One per view.
    image_size : (int, int)
        Width and height in pixels.

    Returns
    -------
    Estimate
        Zhang's closed form with the principal point at the centre and no distortion.

    Raises
    ------
    CameraError
        If the points of a view are collinear.
    """
    import cv2

    for view, each in enumerate(observations):
        for what, places in (("points", each.points[:, :2]), ("pixels", each.pixels)):
            spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
            if spread[1] < _LINE * spread[0]:
                raise CameraError(f"The {what} of view number {view} are collinear: they determine no pose.")
    points = [each.points.astype(np.float32) for each in observations]
    pixels = [each.pixels.astype(np.float32) for each in observations]
    side = float(max(image_size))
    try:
        focal = float(np.asarray(cv2.initCameraMatrix2D(points, pixels, image_size, aspectRatio=1.0))[0, 0])
    except cv2.error:  # some view has no homography
        focal = np.nan
    if not FOCAL_RANGE[0] * side <= focal <= FOCAL_RANGE[1] * side:
        focal = float(np.sqrt(FOCAL_RANGE[0] * FOCAL_RANGE[1])) * side
    width, height = image_size
    intrinsics = np.zeros(lens.size)
    intrinsics[:4] = focal, focal, (width - 1) / 2, (height - 1) / 2
    poses = [pose_of(each, lens, intrinsics) for each in observations]
    return Estimate(intrinsics, np.array([pose[0] for pose in poses]), np.array([pose[1] for pose in poses]))


def pose_of(seen: Observation, lens: Lens, intrinsics: Floats) -> tuple[Floats, Floats]:
    """Return the rotation (3, 3) and translation (3,) of a view for given intrinsic parameters.

    The two poses that fit a flat target (Collins and Bartoli, 2014) are refined, and the better one is returned.

    Raises
    ------
    CameraError
        If the points are collinear or fewer than four.
    """
    import cv2

    fx, fy, cx, cy = intrinsics[:4]
    matrix, pixels = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]), seen.pixels
    distortion = lens.distortion(intrinsics)
    if distortion is not None:
        pixels = distortion.undistort((pixels - (cx, cy)) / (fx, fy)) * (fx, fy) + (cx, cy)
    known = np.isfinite(pixels).all(axis=1)
    points, pixels = seen.points[known], pixels[known]
    try:
        refined = [
            cv2.solvePnPRefineLM(points, pixels, matrix, None, vector, translation)
            for vector, translation in flat_poses(points, pixels, matrix)
        ]
    except cv2.error:
        refined = []
    if not refined:
        raise CameraError("No pose fits the points of this view.")
    costs = [float(((cv2.projectPoints(points, *pose, matrix, None)[0][:, 0] - pixels) ** 2).sum()) for pose in refined]
    if not np.isfinite(costs).any():
        raise CameraError("No pose fits the points of this view.")
    vector, translation = refined[int(np.nanargmin(costs))]
    return np.asarray(cv2.Rodrigues(vector)[0]), np.asarray(translation, dtype=np.float64).ravel()
