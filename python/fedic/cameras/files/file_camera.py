"""What a reader of camera files returns."""

from dataclasses import dataclass

from fedic._internal.types import Camera

__all__ = ["FileCamera"]


@dataclass(frozen=True)
class FileCamera:
    """A camera of a file.

    Attributes
    ----------
    camera : Pinhole, FrontParallel or ImageFrame
        The camera, with the pose in the file, if any.
    missing_pose : str
        For the second or a further camera of a file: a sentence on what the file lacks of its pose; empty if
        the pose is there.
    """

    camera: Camera
    missing_pose: str = ""
