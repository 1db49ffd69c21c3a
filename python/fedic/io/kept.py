"""Images that a result needs again, kept by reference or by the name of their file."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fedic._internal.types import Image
from fedic.errors import FedicError, ImageError
from fedic.io.image_origins import sample_checksum
from fedic.io.images import as_image, mean_image

__all__ = ["KeptImage"]


@dataclass(frozen=True)
class KeptImage:
    """An image to be used again.

    Nothing is copied: an image read by `fedic.read_image` is read again from its file, another one is referenced. A
    checksum of a sample of its pixels tells whether it is still the same. Pickling drops an image without a file.

    Attributes
    ----------
    name : str
        Its name in messages, such as ``"deformed"``.
    path : Path or None
        Its file.
    others : tuple of Path
        More files, if the image is the mean of several.
    array : ndarray or None
        The image, if it has no file.
    checksum : int
        That of the image when it was measured.
    """

    name: str
    path: Path | None
    array: Image | None
    checksum: int
    others: tuple[Path, ...] = ()

    @classmethod
    def of(cls, image: Image, name: str, path: Path | None) -> "KeptImage":
        """Keep an image.

        Parameters
        ----------
        image : ndarray, shape (height, width)
            The image.
        name : str
            Its name in messages.
        path : Path or None
            Its file.

        Returns
        -------
        KeptImage
            Without the array if the image comes from a file.
        """
        return cls(name, path, None if path is not None else image, sample_checksum(as_image(image, name)))

    def read(self) -> Image:
        """Return the image.

        Returns
        -------
        ndarray, shape (height, width)
            The image as measured.

        Raises
        ------
        ImageError
            If it is no longer known, or has changed since.
        """
        if self.path is not None:
            try:
                image = as_image(mean_image([self.path, *self.others], self.name), self.name)
            except FedicError as error:
                raise ImageError(f"The {self.name} image of this result cannot be read again: {error}") from error
        elif self.array is not None:
            image = as_image(self.array, self.name)
        else:
            raise ImageError(
                f"The {self.name} image of this result is not known any more: the result was unpickled or loaded, and "
                "the image was not read from a file. Prepare a fedic.Correlator with the reference image and use its "
                "residual_map and standard_deviations."
            )
        if sample_checksum(image) != self.checksum:
            where = "the array" if self.path is None else str(self.path)
            raise ImageError(
                f"The {self.name} image of this result has changed since the measurement ({where}); keep a copy of it, "
                "or use the methods of fedic.Correlator before it changes."
            )
        return image

    def __getstate__(self) -> dict[str, Any]:
        return replace(self, array=None).__dict__
