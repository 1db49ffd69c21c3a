"""Affine map or homography of the mesh from key points matched between the two images."""

import math

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.starts.candidate import Candidate, refined_candidate
from fedic.starts.images import Level, StartImages
from fedic.starts.motion import affine

__all__ = ["matched_features"]

_SIDE = 800.0
_KEY_POINTS = 2000
_SIFT_CONTRAST = 0.01
_RATIO = 0.9
"""Largest ratio of the distances of the nearest and the second nearest descriptor."""
_TOLERANCE_PX = 3.0
_FEWEST_INLIERS = 8
_HOMOGRAPHY_GAIN = 1.1
"""Ratio of the inliers from which on a homography is preferred to an affine map."""
_MARGIN = 0.05
_DRAWS = 5000


def matched_features(images: StartImages) -> list[Candidate]:
    """Match SIFT key points under the mesh with those of the deformed image, and fit a motion by RANSAC.

    The draws are seeded.

    Parameters
    ----------
    images : StartImages
        The two images and the region of the mesh.

    Returns
    -------
    list of Candidate
        One candidate named ``"features"``, or none.
    """
    if not images.has_texture():
        return []
    level = images.level_of_side(_SIDE)
    here, there = _matches(level)
    if len(here) < _FEWEST_INLIERS:
        return []
    motion = _fitted(here, there)
    if motion is None:
        return []
    found = refined_candidate(images, "features", level.enlarged(motion))
    return [] if found is None else [found]


def _matches(level: Level) -> tuple[Floats, Floats]:
    """Return matching points of the reference and of the deformed image, shapes (k, 2), in pixels of the level."""
    import cv2

    detector = cv2.SIFT.create(nfeatures=_KEY_POINTS, contrastThreshold=_SIFT_CONTRAST)
    size = max(3, round(_MARGIN * max(level.region.shape)) | 1)
    near = cv2.dilate(level.region.astype(np.uint8), np.ones((size, size), dtype=np.uint8))
    key_points, descriptors = [], []
    for image, mask in ((level.reference, near), (level.deformed, None)):
        found, described = detector.detectAndCompute(_eight_bit(image), mask)
        key_points.append(np.array([each.pt for each in found], dtype=np.float64).reshape(-1, 2))
        descriptors.append(described)
    if any(len(points) < 2 for points in key_points):
        return np.empty((0, 2)), np.empty((0, 2))
    pairs = cv2.BFMatcher(cv2.NORM_L2).knnMatch(descriptors[0], descriptors[1], k=2)
    good = [first for first, second in pairs if first.distance < _RATIO * second.distance]
    rows = np.array([(each.queryIdx, each.trainIdx) for each in good], dtype=np.int64).reshape(-1, 2)
    return key_points[0][rows[:, 0]], key_points[1][rows[:, 1]]


def _eight_bit(image: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.asarray(np.clip(np.rint(255.0 * image), 0, 255), dtype=np.uint8)


def _fitted(here: Floats, there: Floats) -> Floats | None:
    """Return the motion, shape (3, 3), that most matches agree with; None if fewer than eight do."""
    import cv2

    cv2.setRNGSeed(0)
    rows, inliers = cv2.estimateAffine2D(
        here, there, method=cv2.RANSAC, ransacReprojThreshold=_TOLERANCE_PX, maxIters=_DRAWS, confidence=0.999
    )
    count = 0 if rows is None else int(np.count_nonzero(inliers))
    cv2.setRNGSeed(0)
    homography, inliers = cv2.findHomography(here, there, cv2.RANSAC, _TOLERANCE_PX, maxIters=_DRAWS, confidence=0.999)
    more = 0 if homography is None else int(np.count_nonzero(inliers))
    if max(count, more) < _FEWEST_INLIERS:
        return None
    best = homography if more > math.ceil(_HOMOGRAPHY_GAIN * count) else affine(np.asarray(rows, dtype=np.float64))
    return np.asarray(best, dtype=np.float64)
