"""Errors of image files, without the name of the file, and the limit of their size."""

from fedic.errors import ImageError
from fedic.io.limits import MAX_BYTES

__all__ = ["check_size", "damaged", "undecodable"]


def damaged(what: str = "") -> ImageError:
    """Return the error of a file whose content contradicts itself or ends early.

    Parameters
    ----------
    what : str
        What was found.

    Returns
    -------
    ImageError
        To be raised.
    """
    found = f": {what}" if what else ""
    return ImageError(f"the image file is truncated or damaged{found}; copy or export it again.")


def undecodable(reason: object) -> ImageError:
    """Return the error of a file that a library cannot decode, for whatever reason.

    Parameters
    ----------
    reason : object
        What the library says.

    Returns
    -------
    ImageError
        To be raised.
    """
    return ImageError(
        f"the image file is truncated or damaged, or of a variant that is not read ({reason!s:.200}); copy it "
        "again, or save it as PNG or TIFF."
    )


def check_size(width: int, height: int, bytes_per_pixel: int) -> None:
    """Refuse an image that is empty, or too large once decoded.

    Parameters
    ----------
    width, height : int
        Size that the header states, in pixels.
    bytes_per_pixel : int
        Bytes of a decoded pixel.

    Raises
    ------
    ImageError
        If the image has no pixel, or more than 4 GiB.
    """
    if width <= 0 or height <= 0:
        raise damaged(f"its header states a size of {width} x {height} px")
    if width * height * bytes_per_pixel > MAX_BYTES:
        raise ImageError(
            f"the image has {width} x {height} px of {bytes_per_pixel} bytes, more than the {MAX_BYTES >> 30} GiB "
            "that fedic decodes; save the part of interest, or an uncompressed TIFF."
        )
