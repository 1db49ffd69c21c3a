"""Files that images in memory were read from."""

import weakref
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fedic._internal.types import Image

__all__ = ["file_of", "remember_file", "sample_checksum"]

_SAMPLES = 1 << 12


@dataclass(frozen=True)
class _Origin:
    image: "weakref.ref[Image]"
    path: Path
    checksum: int


_ORIGINS: dict[int, _Origin] = {}


def remember_file(image: Image, path: Path) -> None:
    """Remember the file of an image as long as the image lives.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image as read.
    path : Path
        Its file.
    """
    key = id(image)
    reference = weakref.ref(image, lambda _: _ORIGINS.pop(key, None))
    _ORIGINS[key] = _Origin(reference, path.absolute(), sample_checksum(image))


def file_of(image: object) -> Path | None:
    """Return the file of an image.

    Parameters
    ----------
    image : object
        An image.

    Returns
    -------
    Path or None
        None if the image was not read from a file, or has been changed since.
    """
    origin = _ORIGINS.get(id(image))
    if origin is None or origin.image() is not image or not isinstance(image, np.ndarray):
        return None
    return origin.path if sample_checksum(image) == origin.checksum else None


def sample_checksum(image: Image) -> int:
    """Return a checksum of a few thousand pixels of an image, which distinguishes recordings.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.

    Returns
    -------
    int
        Checksum of the grey levels.
    """
    pixels = image.reshape(-1)
    step = max(1, pixels.size // _SAMPLES)
    return zlib.crc32(np.ascontiguousarray(pixels[::step]).tobytes())
