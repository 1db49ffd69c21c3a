"""Points of the mesh's frame seen at known pixels, given by hand or found on a target."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fedic._core import Pinhole
from fedic._internal.types import Floats, StrPath
from fedic.cameras.poses import flat_poses, posed
from fedic.errors import CameraError
from fedic.registration._pose import Placeable, pose_jacobian
from fedic.registration._space import in_space

__all__ = ["Pairs", "Place", "checked_pairs", "pair_rows", "pinhole_from_pairs", "read_pairs"]

_FEWEST_FOR_A_POSE = 4


@dataclass(frozen=True, eq=False)
class Pairs:
    """Points and where they are seen.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        In the frame of the mesh; of a target whose place is unknown, in its own with Z its height above the mesh.
    pixels : ndarray, shape (n, 2)
        Where they are seen.
    placed : bool
        Whether the points are in the frame of the mesh.
    noise : float
        Standard deviation of a coordinate of a pixel: as far as it is known, else as it is expected.
    known : bool
        Whether it is known; if not, it comes from what is left.
    """

    points: Floats
    pixels: Floats
    placed: bool = True
    noise: float = 0.5
    known: bool = False


@dataclass(frozen=True)
class Place:
    """Where a target lies on the plane of the mesh: its origin, and the angle of its X axis, in radians."""

    x: float = 0.0
    y: float = 0.0
    angle: float = 0.0

    def carry(self, points: Floats) -> Floats:
        """Take points (n, 3) of the target to the frame of the mesh."""
        carried: Floats = points @ self.turn.T + [self.x, self.y, 0.0]
        return carried

    @property
    def turn(self) -> Floats:
        """The rotation, shape (3, 3)."""
        cos, sin = np.cos(self.angle), np.sin(self.angle)
        return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])

    def moved(self, step: Floats) -> "Place":
        """Return the place moved by steps of x, y and angle."""
        return replace(self, x=self.x + step[0], y=self.y + step[1], angle=self.angle + step[2])


def checked_pairs(points: object) -> Pairs:
    """Check the point pairs a caller gave.

    Raises
    ------
    CameraError
        If they are no pair of arrays (m, 2) or (m, 3) and (m, 2) of finite numbers.
    """
    expected = "give points=(points (m, 2) or (m, 3), pixels (m, 2))"
    try:
        where, at = (np.asarray(each, dtype=np.float64) for each in points)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise CameraError(f"points: not a pair of arrays of numbers; {expected}.") from None
    if where.ndim != 2 or where.shape[1] not in (2, 3) or at.shape != (len(where), 2) or not len(where):
        raise CameraError(f"points: points of shape {where.shape} and pixels of shape {at.shape}; {expected}.")
    bad = np.flatnonzero(~(np.isfinite(where).all(axis=1) & np.isfinite(at).all(axis=1)))
    if len(bad):
        raise CameraError(f"points: pair number {bad[0]} is not finite.")
    return Pairs(in_space(where), at)


def read_pairs(path: StrPath) -> tuple[Floats, Floats]:
    """Read point pairs from a text file.

    Parameters
    ----------
    path : str or path
        A line for each pair: X, Y, u, v or X, Y, Z, u, v, separated by blanks or commas; ``#`` begins a comment.

    Returns
    -------
    points : ndarray, shape (m, 2) or (m, 3)
    pixels : ndarray, shape (m, 2)

    Raises
    ------
    CameraError
        If the file is missing or holds anything else.
    """
    try:
        lines = Path(path).read_text(encoding="utf-8").replace(",", " ").splitlines()
        rows = np.loadtxt(lines, ndmin=2)
    except (OSError, ValueError) as fault:
        raise CameraError(f"{path}: the point pairs cannot be read ({fault}).") from None
    if rows.shape[1] not in (4, 5):
        raise CameraError(f"{path}: {rows.shape[1]} numbers on a line; write X Y u v, or X Y Z u v.")
    return rows[:, :-2], rows[:, -2:]


def pair_rows(camera: Placeable, place: Place | None, pairs: Pairs, names: tuple[str, ...]) -> tuple[Floats, Floats]:
    """Return seen minus projected pixels, (2 n,), and the derivatives of the projection by the unknowns, (2 n, p).

    The unknowns are the free parameters and, where a place is given, those of the place.
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


def pinhole_from_pairs(camera: Pinhole, pairs: Pairs) -> list[Pinhole]:
    """Return the poses a plane of points nearly allows (Collins and Bartoli, 2014); none where they do not apply.

    The lens is taken out first, whatever its model: pixels are taken back to the plane at unit distance.
    """
    import cv2

    flat = np.ptp(pairs.points[:, 2]) == 0.0
    spread = np.linalg.svd(pairs.points[:, :2] - pairs.points[:, :2].mean(axis=0), compute_uv=False)
    if len(pairs.points) < _FEWEST_FOR_A_POSE or not flat or spread[1] < 1e-3 * spread[0]:
        return []
    try:
        retinal = posed(camera, np.eye(3), np.zeros(3)).unproject(pairs.pixels, z=1.0)[:, :2].copy()
    except CameraError:
        return []
    height = np.array([0.0, 0.0, pairs.points[0, 2]])
    found = []
    for vector, translation in flat_poses(pairs.points - height, retinal, np.eye(3)):
        turn = np.asarray(cv2.Rodrigues(vector)[0], dtype=np.float64)
        found.append(posed(camera, turn, translation - turn @ height))
    return found
