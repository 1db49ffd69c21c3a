"""The image file directories of a TIFF file: which of them are images, found without reading the images."""

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fedic.errors import ImageError
from fedic.io.images._faults import damaged

if TYPE_CHECKING:
    from tifffile import TiffFile

__all__ = ["image_offsets"]

_MAX_PAGES = 10_000
"""Directories that are read beyond the page that is asked for."""
_MAX_PAGE = 1_000_000
_MAX_TAGS = 4096
_MAX_SUBIMAGES = 1000
_NEW_KIND, _OLD_KIND, _SUBIMAGES = 254, 255, 330
_REDUCED, _MASK = 1, 4
_OLD_REDUCED = 2
_INTEGERS = {3: "H", 4: "I", 13: "I", 16: "Q", 18: "Q"}


@dataclass(frozen=True)
class _Directory:
    offset: int
    next_offset: int
    is_reduced: bool
    is_mask: bool
    subimages: tuple[int, ...]


def image_offsets(tiff: "TiffFile", page: int | None) -> list[int]:
    """Return the places of the images of a file, in its order.

    Each directory of the chain is followed by its subordinate ones. Reduced images, such as thumbnails, are left out
    unless there are no others; transparency masks always are.

    Parameters
    ----------
    tiff : TiffFile
        The open file.
    page : int or None
        Number of the last image that is of interest; None for all.

    Returns
    -------
    list of int
        Offsets of the directories.

    Raises
    ------
    ImageError
        If the chain leaves the file, runs in a circle or does not end.
    """
    full, reduced = list[int](), list[int]()
    seen = set[int]()
    limit = min(page or 0, _MAX_PAGE) + _MAX_PAGES
    offset = _read(tiff, 8 if tiff.tiff.version == 43 else 4, tiff.tiff.offsetformat)[0]
    while offset and (page is None or len(full) <= page):
        directory = _directory(tiff, offset, seen)
        subimages = [_directory(tiff, place, seen) for place in directory.subimages]
        if len(seen) > limit:
            raise ImageError(
                f"the file lists more than {limit} pages, or is damaged; name a page by its number, such as #0, or "
                "split the file."
            )
        for each in (directory, *subimages):
            if not each.is_mask:
                (reduced if each.is_reduced else full).append(each.offset)
        offset = directory.next_offset
    return full or reduced


def _directory(tiff: "TiffFile", offset: int, seen: set[int]) -> _Directory:
    if offset in seen:
        raise damaged("its list of pages runs in a circle")
    seen.add(offset)
    layout = tiff.tiff
    (count,) = _read(tiff, offset, layout.tagnoformat)
    if not 0 < count <= _MAX_TAGS:
        raise damaged(f"the list of tags at byte {offset} has {count} entries")
    form = f"{layout.byteorder}HHQ8s" if layout.version == 43 else f"{layout.byteorder}HHI4s"
    start = offset + layout.tagnosize
    entries = _bytes(tiff, start, count * layout.tagsize)
    found = {
        code: (kind, number, value)
        for code, kind, number, value in struct.iter_unpack(form, entries)
        if code in (_NEW_KIND, _OLD_KIND, _SUBIMAGES)
    }
    new, old = (_integers(tiff, found[code])[:1] if code in found else () for code in (_NEW_KIND, _OLD_KIND))
    kind = new[0] if new else 0
    return _Directory(
        offset,
        _read(tiff, start + len(entries), layout.offsetformat)[0],
        is_reduced=bool(kind & _REDUCED) or old == (_OLD_REDUCED,),
        is_mask=bool(kind & _MASK),
        subimages=_integers(tiff, found[_SUBIMAGES]) if _SUBIMAGES in found else (),
    )


def _integers(tiff: "TiffFile", entry: tuple[int, int, bytes]) -> tuple[int, ...]:
    kind, count, value = entry
    if kind not in _INTEGERS or count > _MAX_SUBIMAGES:
        raise damaged("a tag that should hold offsets does not")
    form = f"{tiff.tiff.byteorder}{count}{_INTEGERS[kind]}"
    size = struct.calcsize(form)
    if size > len(value):
        (place,) = struct.unpack(tiff.tiff.offsetformat, value)
        value = _bytes(tiff, place, size)
    return struct.unpack(form, value[:size])


def _read(tiff: "TiffFile", offset: int, form: str) -> tuple[int, ...]:
    return struct.unpack(form, _bytes(tiff, offset, struct.calcsize(form)))


def _bytes(tiff: "TiffFile", offset: int, count: int) -> bytes:
    file = tiff.filehandle
    if offset + count > file.size:
        raise damaged(f"its list of pages goes on at byte {offset}, but it has {file.size} bytes")
    file.seek(offset)
    data = file.read(count)
    assert isinstance(data, bytes)
    return data
