"""Frames of videos, read by OpenCV."""

from collections.abc import Iterator
from pathlib import Path

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.files import check_file

__all__ = ["VideoFrames", "is_video"]

_SUFFIXES = frozenset({".avi", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".m4v", ".webm", ".wmv"})


def is_video(path: Path) -> bool:
    """Tell whether the name of a file is that of a video."""
    return path.suffix.lower() in _SUFFIXES


class VideoFrames:
    """The frames of a video as pairs of a time in seconds and a grey image; the first one too.

    Parameters
    ----------
    path : Path
        The video.

    Raises
    ------
    ImageError
        If the file cannot be read or is no video.
    """

    def __init__(self, path: Path) -> None:
        check_file(path, ImageError, "video")
        self._path = path

    def __iter__(self) -> Iterator[tuple[float, Image]]:
        import cv2

        capture = cv2.VideoCapture(str(self._path))
        try:
            if not capture.isOpened():
                raise ImageError(f"{self._path}: OpenCV cannot read this video; convert it to images.")
            while True:
                intact, image = capture.read()
                if not intact:
                    return
                # Of the frame that was read last; before the first two both are zero.
                yield 1e-3 * capture.get(cv2.CAP_PROP_POS_MSEC), cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)  # type: ignore[misc]
        finally:
            capture.release()
