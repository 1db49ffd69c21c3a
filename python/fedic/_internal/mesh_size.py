"""The size of a mesh as a camera sees it, for messages about a wrong scale or a forgotten camera."""

import numpy as np

from fedic._core import FrontParallel, ImageFrame, Mesh
from fedic._internal.types import Camera

__all__ = ["with_size"]

_SMALLEST, _LARGEST = 0.1, 3.0
"""Sizes of the mesh relative to the image below and above which the scale is probably wrong."""


def with_size(message: str, mesh: Mesh, camera: Camera, shape: tuple[int, ...]) -> str:
    """Append the size of the mesh in the image to a message, unless it is usual.

    Parameters
    ----------
    message : str
        The message.
    mesh : Mesh
        The mesh.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    shape : (int, int)
        Height and width of the image.

    Returns
    -------
    str
        The message, with the size.
    """
    pixels = camera.project(mesh.points[mesh.used_nodes])
    if not len(pixels) or not np.isfinite(pixels).all():
        return message
    width, height = np.ptp(pixels, axis=0)
    relative = max(width / shape[1], height / shape[0])
    if _SMALLEST <= relative <= _LARGEST:
        return message
    if isinstance(camera, ImageFrame):
        question = "was the camera forgotten, for a mesh that is not drawn in pixels?"
    elif isinstance(camera, FrontParallel):
        question = f"is the scale of {camera.scale:g} pixels per unit of the mesh right, and not its inverse?"
    else:
        question = "have the mesh and the translation of the camera the same unit?"
    return (
        f"{message.rstrip('.')}. The mesh is {width:.3g} x {height:.3g} px in an image of {shape[1]} x {shape[0]} px: "
        f"{question}"
    )
