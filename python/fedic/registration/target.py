"""A calibration target that lies on the specimen."""

import numpy as np

from fedic._core import Pinhole
from fedic._types import Image
from fedic.calibration.detection import NotFoundError, find_target
from fedic.calibration.refinement import refined
from fedic.calibration.target import Target, parse_target
from fedic.errors import CameraError, ImageError
from fedic.registration.pairs import Pairs, Place, pinhole_from_pairs
from fedic.registration.pose import Placeable, posed

__all__ = ["start_on_target", "target_pairs"]


def target_pairs(image: Image, camera: Placeable, target: str | Target, thickness: float) -> Pairs:
    """Find the points of a target, each measured in its plane.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.
    camera : Pinhole
        Calibrated; its pose does not matter.
    target : str or Target
        Which one.
    thickness : float
        Height of the target's upper face above the mesh.

    Returns
    -------
    Pairs
        In the frame of the target, not placed on the mesh yet.

    Raises
    ------
    CameraError
        If the camera is no pinhole, or the target is misspelt.
    ImageError
        If the target is not in the image.
    """
    plan = parse_target(target) if isinstance(target, str) else target
    if not isinstance(camera, Pinhole):
        raise CameraError(f"target: gives the pose of a calibrated Pinhole, not of a {type(camera).__name__}.")
    if not np.isfinite(thickness):
        raise CameraError(f"target_thickness={thickness}: give a finite height of the target above the mesh.")
    try:
        seen = find_target(image, plan)
    except NotFoundError as fault:
        raise ImageError(f"The target {plan} is not found in the image: {fault}.") from None
    found = Pairs(seen.points, seen.pixels, placed=False)
    poses = pinhole_from_pairs(camera, found)
    if poses:
        seen = refined(image, plan, seen, min(poses, key=lambda pose: _misfit(pose, found)))
    return Pairs(seen.points + np.array([0.0, 0.0, thickness]), seen.pixels, placed=False)


def start_on_target(start: Pinhole, on_target: Pinhole, points: np.ndarray) -> tuple[Pinhole, Place]:
    """Place the mesh in the plane of a target as near as possible to where the start has it.

    Parameters
    ----------
    start : Pinhole
        The rough start, in the frame of the mesh.
    on_target : Pinhole
        The camera in the frame of the target whose Z is zero on the mesh.
    points : ndarray, shape (n, 3)
        Of the mesh, to be seen where the start sees them.

    Returns
    -------
    Pinhole
        The camera in the frame of the mesh.
    Place
        Of the target on the mesh.

    Raises
    ------
    CameraError
        If the start does not see the plane of the target.
    """
    seen = start.project(points)
    if not np.isfinite(seen).all():
        raise CameraError("camera: from its start it does not see the mesh; correct the start.")
    on_plane = on_target.unproject(seen)[:, :2] @ [1.0, 1.0j]
    on_mesh = points[:, :2] @ [1.0, 1.0j]
    centre = on_plane.mean(), on_mesh.mean()
    turn = complex(((on_mesh - centre[1]) * np.conj(on_plane - centre[0])).sum())
    angle = float(np.angle(turn))
    origin = complex(centre[1] - centre[0] * np.exp(1.0j * angle))
    place = Place(origin.real, origin.imag, angle)
    rotation = on_target.rotation @ place.turn.T
    translation = np.asarray(on_target.translation) - rotation @ [place.x, place.y, 0.0]
    return posed(on_target, rotation, translation), place


def _misfit(camera: Pinhole, pairs: Pairs) -> float:
    return float(np.nansum((camera.project(pairs.points) - pairs.pixels) ** 2))
