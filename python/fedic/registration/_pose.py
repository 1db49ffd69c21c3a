"""Pose parameters of a camera: names, derivatives of image points, and cameras with changed parameters.

A front-parallel camera has ``u0 v0 angle scale``: its origin in pixels, its angle in radians, its scale in pixels per
unit. A pinhole has ``rx ry rz``, a rotation of the world about its origin and the camera's axes in radians, and ``tx ty
tz``, the translation in the world's unit.
"""

from collections.abc import Sequence
from typing import TypeAlias

from fedic._core import FrontParallel, Pinhole
from fedic._internal.types import Floats
from fedic.errors import OptionError

__all__ = ["Placeable", "free_parameters", "move", "placeable", "pose_jacobian", "similarity_parameters"]

Placeable: TypeAlias = FrontParallel | Pinhole

_FRONT_PARALLEL = ("u0", "v0", "angle", "scale")
_PINHOLE = ("rx", "ry", "rz", "tx", "ty", "tz")
_SIMILARITY = ("u0", "v0", "angle", "scale", "rz", "tx", "ty", "tz")


def placeable(camera: object) -> Placeable:
    """Check that a camera has a pose.

    Raises
    ------
    OptionError
        If it has none.
    """
    if isinstance(camera, (FrontParallel, Pinhole)):
        return camera
    raise OptionError(
        f"camera: a {type(camera).__name__} has no pose to estimate; give a FrontParallel or a Pinhole with a rough "
        "pose.",
        "camera",
    )


def free_parameters(camera: Placeable, free: Sequence[str] | None) -> tuple[str, ...]:
    """Return the names of the free parameters of a camera, in the order of the camera.

    Parameters
    ----------
    camera : FrontParallel or Pinhole
        The camera.
    free : sequence of str, optional
        Names of the free parameters; by default all.

    Raises
    ------
    OptionError
        If a name is unknown.
    """
    known = _FRONT_PARALLEL if isinstance(camera, FrontParallel) else _PINHOLE
    if free is None:
        return known
    wanted = [free] if isinstance(free, str) else list(free)
    unknown = [name for name in wanted if name not in known]
    if unknown or not wanted:
        given = repr(unknown[0]) if unknown else "nothing"
        raise OptionError(
            f"free: {given} is not a parameter of a {type(camera).__name__}; give any of {', '.join(known)}.", "free"
        )
    return tuple(name for name in known if name in wanted)


def similarity_parameters(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the parameters, among those given, that translate, rotate and scale the image of the mesh."""
    return tuple(name for name in names if name in _SIMILARITY)


def pose_jacobian(camera: Placeable, points: Floats, names: Sequence[str]) -> Floats:
    """Return the derivatives of image points with respect to pose parameters.

    Parameters
    ----------
    camera : FrontParallel or Pinhole
        The camera.
    points : ndarray, shape (n, 3)
        World points.
    names : sequence of str
        The parameters.

    Returns
    -------
    ndarray, shape (n, 2, p)
        Derivatives in pixels per radian, pixel or unit.
    """
    return camera.parameter_jacobian(points, names)


def move(camera: Placeable, names: Sequence[str], steps: Floats) -> Placeable:
    """Return the camera with its parameters changed by steps."""
    return camera.perturbed(dict(zip(names, (float(step) for step in steps), strict=True)))
