"""Stacks that list one page for many images: those of ImageJ, of MetaMorph, and truncated ones of tifffile."""

import json
import math
import re
from typing import TYPE_CHECKING

from fedic.io.images._faults import damaged
from fedic.io.images.tiff._segments import is_contiguous

if TYPE_CHECKING:
    from tifffile import TiffFile, TiffPage

__all__ = ["count_planes", "select_plane"]

_UIC2 = 33629
_IMAGES = re.compile(r"^images=([0-9]{1,9})\s*$", re.MULTILINE)


def count_planes(tiff: "TiffFile", page: "TiffPage") -> int:
    """Return the number of images that follow each other in the data of the only page of a file.

    Parameters
    ----------
    tiff : TiffFile
        The open file.
    page : TiffPage
        Its only page.

    Returns
    -------
    int
        1 for a usual file.

    Raises
    ------
    ImageError
        If the file is cut within the stack.
    """
    stated = _stated(page)
    if stated < 2 or not page.is_final or not is_contiguous(page):
        return 1
    room = (tiff.filehandle.size - page.dataoffsets[0]) // page.nbytes
    if room >= stated:
        return stated
    if room > 1:
        raise damaged(f"it should hold {stated} images, and ends after {room}")
    # The description was copied from a stack to a file of one image.
    return 1


def select_plane(page: "TiffPage", plane: int) -> None:
    """Make a page refer to one image of its stack.

    Parameters
    ----------
    page : TiffPage
        The page, for which `count_planes` is more than `plane`.
    plane : int
        Number of the image.
    """
    page.dataoffsets = (page.dataoffsets[0] + plane * page.nbytes,)
    page.databytecounts = (page.nbytes,)


def _stated(page: "TiffPage") -> int:
    if page.is_stk:
        tag = page.tags.get(_UIC2)
        return 1 if tag is None else int(tag.count)
    if page.is_imagej:
        images = _IMAGES.search(page.imagej_description or "")
        return int(images[1]) if images else 1
    if page.is_shaped:
        stated = json.loads(page.shaped_description or "{}")
        if stated.get("truncated"):
            return int(math.prod(stated["shape"])) // math.prod(page.shape)
    return 1
