"""One frame: an image, or several static images of which the mean is taken."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Image
from fedic.errors import OptionError
from fedic.io.images import image_stem, mean_image

__all__ = ["FrameEntry", "checked_entry", "entry_files", "entry_name", "image_count", "load_entry"]

FrameEntry: TypeAlias = str | Path | NDArray[np.generic] | Sequence["str | Path | NDArray[np.generic]"]
"""A file, an array, or several of them, recorded one after the other of one state."""


def checked_entry(entry: object, name: str) -> FrameEntry:
    """Check one frame.

    Parameters
    ----------
    entry : object
        A file, an array of two dimensions, or a sequence of them.
    name : str
        Its name in messages, such as ``"reference"``.

    Returns
    -------
    FrameEntry
        The same.

    Raises
    ------
    OptionError
        If it is something else.
    """
    if _is_image(entry):
        return entry  # type: ignore[return-value]
    if isinstance(entry, (list, tuple)) and entry and all(map(_is_image, entry)):
        return entry
    raise OptionError(
        f"{name} is {_kind(entry)}; give an image file, an array of shape (height, width), or a list of them, of which "
        "the mean is taken",
        "reference" if name == "reference" else "frames",
    )


def image_count(entry: FrameEntry) -> int:
    """Return the number of images of an entry."""
    return len(entry) if isinstance(entry, (list, tuple)) else 1


def entry_files(entry: FrameEntry) -> list[Path]:
    """Return the names of the files of an entry; empty for arrays."""
    parts = entry if isinstance(entry, (list, tuple)) else [entry]
    return [Path(part) for part in parts if isinstance(part, (str, Path))]


def entry_name(entry: FrameEntry, index: int) -> str:
    """Return the name of a frame: that of its first file, or its number.

    Parameters
    ----------
    entry : FrameEntry
        The frame.
    index : int
        Its number.

    Returns
    -------
    str
        ``"frame_12"`` for ``"frame_12.tif"``, ``"frame 12"`` for an array.
    """
    files = entry_files(entry)
    return image_stem(files[0]) if files else f"frame {index}"


def load_entry(entry: FrameEntry, name: str) -> Image:
    """Return the image of an entry: as read, or the mean of several as float32.

    Parameters
    ----------
    entry : FrameEntry
        The frame.
    name : str
        Its name in messages.

    Returns
    -------
    ndarray, shape (height, width)
        The image.

    Raises
    ------
    ImageError
        If an image cannot be read, or the images of a mean differ in size.
    """
    parts: Any = entry if isinstance(entry, (list, tuple)) else [entry]
    return mean_image(parts, name)


def _is_image(value: object) -> bool:
    return isinstance(value, (str, Path)) or (isinstance(value, np.ndarray) and value.ndim == 2)


def _kind(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    return f"a {type(value).__name__}" + (" without entries" if value in ([], ()) else "")
