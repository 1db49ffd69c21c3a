"""Unit of length of a mesh, as labels and files name it."""

from fedic._core import ImageFrame
from fedic._internal.types import Camera
from fedic.errors import OptionError

__all__ = ["checked_unit"]

_LONGEST = 20


def checked_unit(unit: object, camera: Camera) -> str:
    """Check the name of a unit.

    Parameters
    ----------
    unit : object
        Value given by the caller; None if the unit is not known.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera; a mesh drawn in the pixels of the image has the unit ``px``.

    Returns
    -------
    str
        The unit; empty if it is not known.

    Raises
    ------
    OptionError
        If it is not a short text, or another than pixels for a mesh drawn in pixels.
    """
    if isinstance(camera, ImageFrame) and camera.scale == 1.0:
        if unit not in (None, "px"):
            raise OptionError(
                f"unit={unit!r}: a mesh drawn in pixels (ImageFrame) has the unit px; give a FrontParallel or a "
                "Pinhole for a mesh in another unit.",
                "unit",
            )
        return "px"
    if unit is None:
        return ""
    if not isinstance(unit, str) or not unit.strip() or len(unit) > _LONGEST or not unit.isprintable():
        raise OptionError(
            f"unit={unit!r}: give the unit of length of the mesh, such as 'mm', in up to {_LONGEST} letters.", "unit"
        )
    return unit.strip()
