"""Point pairs: points in the frame of the mesh and their image points, given by hand or found on a target."""

from dataclasses import dataclass, replace

import numpy as np

from fedic._core import FrontParallel, Pinhole
from fedic._internal.types import Floats
from fedic.cameras.poses import flat_poses, with_pose
from fedic.errors import CameraError, OptionError
from fedic.registration._pose import Placeable, pose_jacobian
from fedic.registration._space import in_space

__all__ = [
    "Pairs",
    "Place",
    "check_not_mirrored",
    "checked_pairs",
    "front_parallel_from_pairs",
    "pair_rows",
    "pinhole_from_pairs",
]

_FEWEST_FOR_A_POSE = 4
_FLATTEST = 0.05
"""Ratio of the sides of points that are taken for collinear, and of the distances that are taken for errors."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Points and their image points.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        Points in the frame of the mesh; those of a target of unknown placement in its own frame, Z being the height
        above the mesh.
    pixels : ndarray, shape (n, 2)
        Image points.
    placed : bool
        True if the points are in the frame of the mesh.
    noise : float
        Standard deviation of a coordinate of an image point, in pixels; an expected value if not `known`.
    known : bool
        True if the noise is known; otherwise it is estimated from the residuals.
    """

    points: Floats
    pixels: Floats
    placed: bool = True
    noise: float = 0.5
    known: bool = False


@dataclass(frozen=True)
class Place:
    """Placement of a target on the plane of the mesh: its origin, and the angle of its X axis in radians."""

    x: float = 0.0
    y: float = 0.0
    angle: float = 0.0

    def carry(self, points: Floats) -> Floats:
        """Transform points (n, 3) of the target to the frame of the mesh."""
        carried: Floats = points @ self.turn.T + [self.x, self.y, 0.0]
        return carried

    @property
    def turn(self) -> Floats:
        """Rotation matrix, shape (3, 3)."""
        cos, sin = np.cos(self.angle), np.sin(self.angle)
        return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])

    def moved(self, step: Floats) -> "Place":
        """Return the placement changed by steps of x, y and angle."""
        return replace(self, x=self.x + step[0], y=self.y + step[1], angle=self.angle + step[2])


def checked_pairs(points: object) -> Pairs:
    """Check point pairs given by the caller.

    Raises
    ------
    OptionError
        If they are not a pair of arrays (m, 2) or (m, 3) and (m, 2) of finite numbers.
    """
    expected = "give points=(points (m, 2) or (m, 3), pixels (m, 2))"
    try:
        where, at = (np.asarray(each, dtype=np.float64) for each in points)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise OptionError(f"points: not a pair of arrays of numbers; {expected}.", "points") from None
    if where.ndim != 2 or where.shape[1] not in (2, 3) or at.shape != (len(where), 2) or not len(where):
        raise OptionError(
            f"points: points of shape {where.shape} and pixels of shape {at.shape}; {expected}.", "points"
        )
    bad = np.flatnonzero(~(np.isfinite(where).all(axis=1) & np.isfinite(at).all(axis=1)))
    if len(bad):
        raise OptionError(f"points: pair number {bad[0]} is not finite.", "points")
    return Pairs(in_space(where), at)


def check_not_mirrored(pairs: Pairs) -> None:
    """Check that a front-parallel camera, which never mirrors, can have seen the points where they are given.

    Raises
    ------
    OptionError
        If the image points are the mirror image of the points.
    """
    rows = np.column_stack([pairs.points[:, :2], np.ones(len(pairs.points))])
    rows[:, :2] -= rows[:, :2].mean(axis=0)
    sizes = np.linalg.svd(rows[:, :2], compute_uv=False)
    if len(rows) < 3 or sizes[1] < _FLATTEST * sizes[0]:
        return
    solution = np.linalg.lstsq(rows, pairs.pixels, rcond=None)[0]
    left = np.abs(pairs.pixels - rows @ solution).max()
    # Y points up and v down.
    if np.linalg.det(solution[:2]) > 0.0 and left < _FLATTEST * np.ptp(pairs.pixels, axis=0).max():
        raise OptionError(
            "points: the image points are the mirror image of the points. Y points up and v down, and u is the column: "
            "change the sign of Y if it was measured downwards, exchange u and v if v comes first, or mirror the mesh "
            "if it is drawn as seen from the other side.",
            "points",
        )


def pair_rows(camera: Placeable, place: Place | None, pairs: Pairs, names: tuple[str, ...]) -> tuple[Floats, Floats]:
    """Return the residuals (2 n,), measured minus projected, and the Jacobian (2 n, p) of the projection.

    The unknowns are the free parameters and, if a placement is given, its x, y and angle.
    """
    points = pairs.points if pairs.placed or place is None else place.carry(pairs.points)
    residuals = (pairs.pixels - camera.project(points)).ravel()
    jacobian = pose_jacobian(camera, points, names)
    if place is not None:
        slopes = camera.jacobian(points)
        by_place = np.zeros((len(points), 2, 3))
        if not pairs.placed:
            arms = points - [place.x, place.y, 0.0]
            turned = np.column_stack([-arms[:, 1], arms[:, 0], np.zeros(len(arms))])
            by_place[:, :, :2] = slopes[:, :, :2]
            by_place[:, :, 2] = np.einsum("nij,nj->ni", slopes, turned)
        jacobian = np.concatenate([jacobian, by_place], axis=2)
    return residuals, jacobian.reshape(len(residuals), -1)


def front_parallel_from_pairs(pairs: Pairs) -> list[FrontParallel]:
    """Return the camera that fits points best; none if they are at one place."""
    places, seen = pairs.points[:, :2] @ [1.0, 1.0j], pairs.pixels @ [1.0, -1.0j]
    arms = places - places.mean()
    size = float(np.abs(arms).max())
    factor = complex(np.vdot(arms, seen)) / float(np.vdot(arms, arms).real) if size > 0.0 else 0.0j
    if abs(factor) * size < 1e-6:
        return []
    origin = complex(seen.mean() - factor * places.mean())
    return [FrontParallel(abs(factor), (origin.real, -origin.imag), float(np.angle(factor)))]


def pinhole_from_pairs(camera: Pinhole, pairs: Pairs) -> list[Pinhole]:
    """Return the one or two poses that fit coplanar points (Collins and Bartoli, 2014); none if they are not coplanar.

    The distortion is removed first, for any lens model, by unprojecting the image points to the plane at unit distance.
    """
    import cv2

    flat = np.ptp(pairs.points[:, 2]) == 0.0
    spread = np.linalg.svd(pairs.points[:, :2] - pairs.points[:, :2].mean(axis=0), compute_uv=False)
    if len(pairs.points) < _FEWEST_FOR_A_POSE or not flat or spread[1] < 1e-3 * spread[0]:
        return []
    try:
        retinal = with_pose(camera, np.eye(3), np.zeros(3)).unproject(pairs.pixels, z=1.0)[:, :2].copy()
    except CameraError:
        return []
    height = np.array([0.0, 0.0, pairs.points[0, 2]])
    found = []
    for vector, translation in flat_poses(pairs.points - height, retinal, np.eye(3)):
        turn = np.asarray(cv2.Rodrigues(vector)[0], dtype=np.float64)
        found.append(with_pose(camera, turn, translation - turn @ height))
    return found
