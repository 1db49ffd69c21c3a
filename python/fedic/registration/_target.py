"""Calibration targets on the specimen."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import cast

import numpy as np

from fedic._core import Pinhole
from fedic._internal.types import Floats, Image
from fedic.calibration.detection import NotFoundError, find_target, refine_points
from fedic.calibration.observation import Observation
from fedic.calibration.target import Target, parse_target
from fedic.cameras.poses import with_pose
from fedic.errors import CameraError, ImageError, OptionError
from fedic.registration._numbers import finite_number
from fedic.registration._pairs import Pairs, Place, pinhole_from_pairs
from fedic.registration._pose import Placeable

__all__ = ["LyingTarget", "lying_target", "start_on_target", "target_pairs"]

_SMOOTHINGS = (0.0, 1.5, 3.0)
"""Gaussian smoothing of the image, in pixels, tried in turn: speckles around a target mislead its detection."""
_FARTHEST_PX = 1.0
_NOISE_PX = 0.05


@dataclass(frozen=True)
class LyingTarget:
    """A target on the specimen.

    Attributes
    ----------
    plan : Target
        Printed pattern.
    place : Place, optional
        Placement on the mesh.
    thickness : float
        Height of the printed face above the mesh.
    """

    plan: Target
    place: Place | None
    thickness: float


def lying_target(target: object, origin: object, angle: object, thickness: object) -> LyingTarget | None:
    """Check the target arguments given by the caller; return None without a target.

    Raises
    ------
    OptionError
        If an argument is malformed, or needs a target or an origin that is not given.
    """
    height = finite_number("target_thickness", thickness, "a finite height of the target above the mesh")
    if target is None:
        given = {"target_origin": origin is not None, "target_angle": angle is not None, "target_thickness": height}
        said = [name for name, is_given in given.items() if is_given]
        if said:
            raise OptionError(f"{said[0]} is given without a target; add target=....", said[0])
        return None
    if not isinstance(target, (str, Target)):
        raise OptionError(f"target is a {type(target).__name__}; give a text such as 'chessboard:11x7:8'.", "target")
    plan = parse_target(target) if isinstance(target, str) else target
    if origin is None:
        if angle is not None:
            raise OptionError(
                "target_angle is given without target_origin, about which it turns; add target_origin=(x, y), or "
                "leave the angle out.",
                "target_angle",
            )
        return LyingTarget(plan, None, height)
    numbers = list(origin) if isinstance(origin, Iterable) else []
    if len(numbers) != 2:
        raise OptionError(f"target_origin={origin!r}: give (x, y) in the frame of the mesh.", "target_origin")
    x, y = (finite_number("target_origin", each, "(x, y), both finite, in the frame of the mesh") for each in numbers)
    turn = 0.0 if angle is None else finite_number("target_angle", angle, "a finite angle in radians")
    return LyingTarget(plan, Place(x, y, turn), height)


def target_pairs(image: Image, camera: Placeable, lying: LyingTarget) -> Pairs:
    """Find the points of a target, refined in its plane.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.
    camera : Pinhole
        Calibrated camera; its pose is not used.
    lying : LyingTarget
        The target.

    Returns
    -------
    Pairs
        Points in the frame of the target, not yet placed on the mesh.

    Raises
    ------
    OptionError
        If the camera is not a pinhole.
    ImageError
        If the target is not in the image, or the pattern found fits no pose.
    """
    if not isinstance(camera, Pinhole):
        raise OptionError(f"target: needs a calibrated Pinhole, not a {type(camera).__name__}.", "target")
    plan, height = lying.plan, np.array([0.0, 0.0, lying.thickness])
    faults = []
    for smoothing in _SMOOTHINGS:
        try:
            seen = find_target(_smoothed(image, smoothing), plan)
        except NotFoundError as fault:
            faults.append(str(fault))
            continue
        pose = _pose(camera, seen)
        if pose is not None:
            seen = refine_points(image, plan, seen, pose)
            pose = _pose(camera, seen)
        error = np.inf if pose is None else _misfit(pose, seen)
        if error <= _FARTHEST_PX:
            return Pairs(seen.points + height, seen.pixels, placed=False, noise=_NOISE_PX)
        faults.append(
            f"a similar grid is found, but no pose of this camera fits its points to less than {error:.2g} px: "
            "speckles mistaken for the target, a bent target, or another calibration"
        )
    raise ImageError(f"The target {plan} is not found in the image: {faults[-1]}.")


def start_on_target(start: Pinhole, on_target: Pinhole, points: Floats) -> tuple[Pinhole, Place]:
    """Place the mesh in the plane of a target, as near as possible to its position in the start.

    Parameters
    ----------
    start : Pinhole
        Rough start, in the frame of the mesh.
    on_target : Pinhole
        Camera in the frame of the target, Z = 0 on the mesh.
    points : ndarray, shape (n, 3)
        Points of the mesh, whose image points are to stay those of the start.

    Returns
    -------
    Pinhole
        Camera in the frame of the mesh.
    Place
        Placement of the target on the mesh.

    Raises
    ------
    CameraError
        If the start does not see the plane of the target.
    """
    seen = start.project(points)
    if not np.isfinite(seen).all():
        raise CameraError("camera: the given pose does not see the mesh; correct it.")
    on_plane = on_target.unproject(seen)[:, :2] @ [1.0, 1.0j]
    on_mesh = points[:, :2] @ [1.0, 1.0j]
    centre = on_plane.mean(), on_mesh.mean()
    turn = complex(((on_mesh - centre[1]) * np.conj(on_plane - centre[0])).sum())
    angle = float(np.angle(turn))
    origin = complex(centre[1] - centre[0] * np.exp(1.0j * angle))
    place = Place(origin.real, origin.imag, angle)
    rotation = on_target.rotation @ place.turn.T
    translation = np.asarray(on_target.translation) - rotation @ [place.x, place.y, 0.0]
    return with_pose(on_target, rotation, translation), place


def _smoothed(image: Image, smoothing: float) -> Image:
    import cv2

    return image if smoothing == 0.0 else cast(Image, cv2.GaussianBlur(image, (0, 0), smoothing))


def _pose(camera: Pinhole, seen: Observation) -> Pinhole | None:
    """Return the better of the poses that fit coplanar points; None if there is none."""
    poses = pinhole_from_pairs(camera, Pairs(seen.points, seen.pixels))
    return min(poses, key=lambda pose: _misfit(pose, seen), default=None)


def _misfit(camera: Pinhole, seen: Observation) -> float:
    """Return the root mean square distance in pixels."""
    squares = ((camera.project(seen.points) - seen.pixels) ** 2).sum(axis=1)
    return float(np.sqrt(squares.mean())) if np.isfinite(squares).all() else np.inf
