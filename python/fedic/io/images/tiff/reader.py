"""Reading one page of a TIFF file."""

import logging
from pathlib import Path
from typing import TYPE_CHECKING

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._faults import check_size, damaged
from fedic.io.images.tiff._colours import colour_samples, grey_levels
from fedic.io.images.tiff._compressions import check_compression
from fedic.io.images.tiff._directories import image_offsets
from fedic.io.images.tiff._planes import count_planes, select_plane
from fedic.io.images.tiff._segments import check_segments, is_contiguous, read_samples

if TYPE_CHECKING:
    from tifffile import TiffFile, TiffPage

__all__ = ["read_tiff"]

_MAPPED_BYTES = 1 << 26
"""Size from which memory mapping an image is worthwhile."""
_NO_OUTPUT = logging.NullHandler()


def read_tiff(path: Path, page: int | None, mapped: bool) -> Image:
    """Read a TIFF file.

    Parameters
    ----------
    path : Path
        The file.
    page : int or None
        Number of the page; None if the file holds one only.
    mapped : bool
        Whether to map a large uncompressed image.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        The grey levels.

    Raises
    ------
    ImageError
        If the page does not exist, or cannot be read right.
    """
    import tifffile

    # What tifffile logs about a damaged file is told by the errors.
    logging.getLogger("tifffile").addHandler(_NO_OUTPUT)
    with tifffile.TiffFile(path, is_lsm=False, is_ndpi=False, is_scanimage=False) as tiff:
        chosen = _choose(tiff, page, path.name)
        if chosen.imagedepth != 1:
            raise ImageError(f"it is a volume of {chosen.imagedepth} slices in one page; save each in its own file.")
        if chosen.dtype is None or not isinstance(chosen.bitspersample, int):
            raise ImageError(
                f"its samples have {chosen.bitspersample} bits and format {chosen.sampleformat}, which is not read; "
                "save it in 8 bit, 16 bit or 32-bit float."
            )
        colours = colour_samples(chosen)
        check_compression(chosen)
        check_segments(chosen)
        contiguous = is_contiguous(chosen)
        if not contiguous:
            check_size(chosen.imagewidth, chosen.imagelength, chosen.samplesperpixel * max(chosen.dtype.itemsize, 1))
        can_map = contiguous and chosen.is_memmappable and colours == 1
        samples = read_samples(chosen, mapped=mapped and can_map and chosen.nbytes >= _MAPPED_BYTES)
        return grey_levels(chosen, samples)


def _choose(tiff: "TiffFile", page: int | None, name: str) -> "TiffPage":
    import tifffile

    offsets = image_offsets(tiff, page)
    if not offsets:
        raise damaged("it holds no image")
    tiff.filehandle.seek(offsets[min(page or 0, len(offsets) - 1)])
    chosen = tifffile.TiffPage(tiff, index=0)
    planes = count_planes(tiff, chosen) if len(offsets) == 1 else 1
    count = len(offsets) * planes
    if page is None and count > 1:
        raise ImageError(
            f"the file holds {count} pages; name one by its number, from 0: {name}#0 to {name}#{count - 1}."
        )
    if page is not None and page >= count:
        raise ImageError(f"page {page} does not exist: the file holds {count}, counted from 0.")
    if planes > 1:
        select_plane(chosen, page or 0)
    return chosen
