"""The reference image on its way to the workers."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fedic._internal.types import Image
from fedic.campaign.frames import load_entry
from fedic.errors import FedicError, ImageError
from fedic.io.image_origins import sample_checksum

__all__ = ["SentReference", "is_readable"]


@dataclass(frozen=True, eq=False)
class SentReference:
    """A reference image as it is sent: the names of its files, or the array.

    Attributes
    ----------
    source : list of Path, or ndarray of shape (height, width)
        The files, of which the mean is taken, or the image.
    checksum : int
        Checksum of a sample of the image.
    """

    source: list[Path] | Image
    checksum: int

    def image(self) -> Image:
        """Return the image.

        Returns
        -------
        ndarray, shape (height, width)
            The image.

        Raises
        ------
        ImageError
            If a file cannot be read, or holds another image.
        """
        image = load_entry(self.source, "reference")
        if sample_checksum(image) != self.checksum:
            raise ImageError(f"{self.source}: the reference image is another one on this worker.")
        return image


def is_readable(files: Sequence[Path], checksum: int) -> bool:
    """Tell whether this process reads a reference image from its files.

    Parameters
    ----------
    files : sequence of Path
        The files.
    checksum : int
        Checksum of a sample of the image.

    Returns
    -------
    bool
        False if they cannot be read or hold another image.
    """
    try:
        SentReference(list(files), checksum).image()
    except (FedicError, OSError, MemoryError):
        return False
    return True
