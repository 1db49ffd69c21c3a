"""Reading an image file of any format."""

from pathlib import Path

import numpy as np

from fedic._internal.types import Image, StrPath
from fedic.errors import ImageError
from fedic.io.files import check_file
from fedic.io.image_origins import remember_file
from fedic.io.images._faults import damaged, undecodable
from fedic.io.images.page_names import split_page

__all__ = ["read_image"]


def read_image(path: StrPath, *, mapped: bool = False) -> Image:
    """Read an image file as grey levels.

    TIFF, PNG, JPEG, BMP, JPEG 2000, JPEG XL, WebP, PGM, PPM, PBM, PFM and NumPy's ``.npy`` are read. Grey levels are
    kept as stored: 8 bit, 16 bit or 32-bit float. Colour is reduced to luminance (Rec. 601) in its own depth. The rows
    and columns are those of the sensor: tags of orientation are ignored. The rules are in ``docs/images.md``.

    Parameters
    ----------
    path : str or path
        The image file. Its format is recognised by its content. ``"stack.tif#3"`` names a page of a file of several
        pages, which are counted from 0.
    mapped : bool
        Map an uncompressed TIFF image of 64 MB or more from its file, as ``fedic run`` does: the system reads the parts
        in use and can release their memory. The returned array is read-only for any file. The file must not change
        while the array is in use: rewriting it changes the grey levels, truncating it ends the process with a bus
        error, and Windows refuses to delete or replace it.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        Indexed ``image[v, u]``.

    Raises
    ------
    ImageError
        If the file is missing, empty, not a regular file, truncated, damaged, or of a format that is not read; if it
        holds several pages and the path names none of them; or if it would take more than 4 GiB once decoded.
    """
    file, page = split_page(path)
    whole = Path(path)
    check_file(file, ImageError, "image file")
    try:
        image = _read(file, page, mapped=mapped)
    except ImageError as error:
        raise ImageError(f"{whole}: {error}") from error.__cause__
    except OSError as error:
        raise ImageError(f"{whole}: the image file cannot be read ({error.strerror or error}).") from error
    except MemoryError as error:
        raise ImageError(f"{whole}: there is not enough memory for this image.") from error
    except Exception as error:  # decoders raise anything on a damaged file
        raise ImageError(f"{whole}: {undecodable(error)}") from error
    if mapped:
        _freeze(image)
    remember_file(image, whole)
    return image


def _read(path: Path, page: int | None, *, mapped: bool) -> Image:
    from fedic.io.images._formats import HEADER_BYTES, recognise  # not needed by `import fedic`

    with path.open("rb") as file:
        header = file.read(HEADER_BYTES)
    if not header:
        raise ImageError("the image file is empty (0 bytes).")
    image = recognise(header, path)(path, page, mapped)
    if image.size == 0:
        raise damaged("it has no pixels")
    return image


def _freeze(image: Image) -> None:
    base: object = image
    while isinstance(base, np.ndarray):
        base.flags.writeable = False
        base = base.base
