"""The samples of a page, from its strips or tiles."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fedic.io.images._faults import damaged
from fedic.io.images.tiff._compressions import JPEG, LZW, PACKBITS, check_segment

if TYPE_CHECKING:
    from tifffile import TiffPage

__all__ = ["check_segments", "is_contiguous", "read_samples"]


def is_contiguous(page: "TiffPage") -> bool:
    """Return whether the samples of a page are uncompressed and follow each other in the file.

    Parameters
    ----------
    page : TiffPage
        The page.

    Returns
    -------
    bool
        False also where tifffile takes it for granted, in files of some microscopes.
    """
    offsets, counts = page.dataoffsets, page.databytecounts
    return page.is_contiguous and all(
        start + count == following for start, count, following in zip(offsets, counts, offsets[1:], strict=False)
    )


def check_segments(page: "TiffPage") -> None:
    """Refuse a page whose strips or tiles are missing, empty or outside the file.

    Parameters
    ----------
    page : TiffPage
        The page.

    Raises
    ------
    ImageError
        If it is damaged.
    """
    offsets, counts = page.dataoffsets, page.databytecounts
    if not (page.tilelength if page.is_tiled else page.rowsperstrip):
        raise damaged("its strips or tiles have no rows")
    contiguous = is_contiguous(page)
    needed = 1 if contiguous else math.prod(page.chunked)
    name = "tiles" if page.is_tiled else "strips"
    if len(offsets) < needed or len(counts) < needed:
        raise damaged(f"it has {min(len(offsets), len(counts))} of the {needed} {name} that its size needs")
    if any(offset <= 0 or count <= 0 for offset, count in zip(offsets, counts, strict=False)):
        raise damaged(f"some of its {name} are missing")
    size = page.parent.filehandle.size
    if any(offset + count > size for offset, count in zip(offsets, counts, strict=False)):
        raise damaged(f"some of its {name} lie beyond its end")
    if contiguous and min(sum(counts), size - offsets[0]) < page.nbytes:
        raise damaged(f"its {name} hold {sum(counts)} bytes, and its size needs {page.nbytes}")


def read_samples(page: "TiffPage", *, mapped: bool) -> NDArray[Any]:
    """Decode a page that passed `check_segments`.

    Parameters
    ----------
    page : TiffPage
        The page.
    mapped : bool
        Whether to map the samples from the file, which must be possible.

    Returns
    -------
    ndarray, shape (height, width, samples)
        The samples as stored, in native byte order.

    Raises
    ------
    ImageError
        If a strip or tile decodes to another size or type than the page states.
    """
    contiguous = is_contiguous(page)
    samples = page.asarray(out="memmap" if mapped else None, squeeze=False) if contiguous else _decode(page)
    return samples[0, 0] if page.planarconfig == 1 else np.moveaxis(samples[:, 0, :, :, 0], 0, -1)


def _decode(page: "TiffPage") -> NDArray[Any]:
    assert page.dtype is not None
    samples = np.empty(page.shaped, page.dtype)
    # Bits of fax compressions come as bytes.
    types = (np.bool_, np.uint8) if page.dtype.kind == "b" else (page.dtype.type,)
    file = page.parent.filehandle
    needed = math.prod(page.chunked)
    tables = {"jpegtables": page.jpegtables} if page.compression in JPEG else {}
    for index, (offset, count) in enumerate(zip(page.dataoffsets[:needed], page.databytecounts, strict=False)):
        file.seek(offset)
        data = file.read(count)
        check_segment(page, data)
        _check_length(page, index, data)
        segment, (plane, depth, row, column, _), _ = page.decode(data, index, **tables)
        if segment is None or segment.dtype.type not in types:
            found = "nothing" if segment is None else f"{segment.dtype} values"
            raise damaged(f"it states {page.dtype} values, and holds {found}")
        room = samples[plane, depth:, row:, column:]
        part = segment[: room.shape[0], : room.shape[1], : room.shape[2]]
        if part.shape[3] != room.shape[3]:
            raise damaged(f"it states {room.shape[3]} samples per pixel, and holds {part.shape[3]}")
        room[: part.shape[0], : part.shape[1], : part.shape[2]] = part
    return samples


def _check_length(page: "TiffPage", index: int, data: bytes) -> None:
    """Refuse a strip or tile of a compression without checksum that decodes to another length than its rows have."""
    if page.compression not in (LZW, PACKBITS):
        return
    import imagecodecs

    expected = _expected_bytes(page, index)
    decode = imagecodecs.lzw_decode if page.compression == LZW else imagecodecs.packbits_decode
    try:
        # With room for one byte too many; without a limit, damaged data can end the process.
        decoded = len(decode(data, out=max(expected) + 1))
    except Exception as error:
        raise damaged(f"strip or tile {index} cannot be decoded ({error})") from error
    if decoded not in expected:
        raise damaged(f"strip or tile {index} decodes to {decoded} bytes instead of {expected[0]}")


def _expected_bytes(page: "TiffPage", index: int) -> tuple[int, int]:
    """Return the bytes of a strip or tile, and of one that is filled up to its full height."""
    samples = page.samplesperpixel if page.planarconfig == 1 else 1
    width, height = (page.tilewidth, page.tilelength) if page.is_tiled else (page.imagewidth, page.rowsperstrip)
    row = (width * samples * page.bitspersample + 7) // 8
    if page.is_tiled:
        return row * height, row * height
    strips = math.ceil(page.imagelength / height)
    return row * min(height, page.imagelength - index % strips * height), row * height
