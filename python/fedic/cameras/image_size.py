"""The size of the images that a camera was calibrated on, against that of an image."""

from fedic._internal.types import Camera
from fedic.errors import CameraError

__all__ = ["check_image_size"]


def check_image_size(camera: Camera, shape: tuple[int, ...], image: str) -> None:
    """Check that an image has the size that the camera was calibrated on, if the camera knows it.

    Parameters
    ----------
    camera : Camera
        The camera.
    shape : tuple of int
        Shape ``(height, width)`` of the image.
    image : str
        The image in messages, such as ``"reference"``.

    Raises
    ------
    CameraError
        If the sizes differ.
    """
    size: tuple[int, int] | None = getattr(camera, "image_size", None)  # what is no camera is refused by the core
    height, width = shape[:2]
    if size is None or size == (width, height):
        return
    raise CameraError(
        f"The {image} image has {width} x {height} px, but the camera is that of images of {size[0]} x {size[1]} px. "
        f"For a region of those give camera.cropped(left, top, {width}, {height}), for images of which n x n pixels "
        "were made one give camera.binned(n); in [camera] of a run, crop and binning. For any other image calibrate "
        "again."
    )
