"""Image files, and checks of images given as arrays."""

import mmap
import struct
import zlib
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Image, StrPath
from fedic.errors import ImageError
from fedic.io.image_origins import remember_file

__all__ = ["as_image", "copy_if_writable", "read_image", "release_pages", "validate_deformed"]

_TIFF_SIGNATURES = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_JPEG_SIGNATURE = b"\xff\xd8\xff"
_BMP_SIGNATURE = b"BM"
_MAPPED_BYTES = 1 << 26
"""Size from which memory mapping an image is worthwhile."""


def read_image(path: StrPath, *, mapped: bool = False) -> Image:
    """Read a TIFF, PNG, BMP or JPEG image as grey levels.

    Grey levels are kept as stored: 8 bit, 16 bit or 32-bit float. Colour is reduced to luminance (Rec. 601) in its own
    depth.

    Parameters
    ----------
    path : str or path
        The image file. Its format is recognised by its content.
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
        If the file is missing, empty, truncated, damaged, of another format, or holds several pages.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            data = file.read(4)
            is_tiff = data.startswith(_TIFF_SIGNATURES)
            data += b"" if is_tiff else file.read()
    except FileNotFoundError:
        raise ImageError(f"{path}: there is no such image file; check the path.") from None
    except OSError as error:
        raise ImageError(f"{path}: the image file cannot be read ({error.strerror}).") from error
    if not data:
        raise ImageError(f"{path}: the image file is empty (0 bytes).")

    image = _decode_tiff(path, mapped=mapped) if is_tiff else _decode_intact(path, data)
    if mapped:
        _freeze(image)
    remember_file(image, path)
    return image


def _decode_intact(path: Path, data: bytes) -> Image:
    if data.startswith(_PNG_SIGNATURE):
        intact = _png_is_intact(data)
    elif data.startswith(_JPEG_SIGNATURE):
        intact = _jpeg_is_complete(data)
    elif data.startswith(_BMP_SIGNATURE):
        intact = _bmp_is_complete(data)
    else:
        raise ImageError(f"{path}: the image format is not supported; convert it to TIFF, PNG, BMP or JPEG.")
    if not intact:
        raise _damaged(path)
    return _to_grey(path, _decode_with_opencv(path, data), blue_first=True)


def as_image(image: object, name: str) -> Image:
    """Check an array of grey levels.

    Parameters
    ----------
    image : object
        Image given by the caller.
    name : str
        Name in messages, such as ``"reference"``.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        The array, made contiguous; float64 becomes float32.

    Raises
    ------
    ImageError
        If it is not a 2-D array of one of these types.
    """
    if not isinstance(image, np.ndarray):
        raise ImageError(
            f"The {name} image is a {type(image).__name__}; give a NumPy array (fedic.read_image reads files)."
        )
    if image.ndim != 2:
        raise ImageError(
            f"The {name} image has shape {image.shape}; give a grey image of shape (height, width) "
            "(fedic.read_image reduces colour to luminance)."
        )
    if image.dtype.type not in (np.uint8, np.uint16, np.float32, np.float64):
        raise ImageError(f"The {name} image holds {image.dtype} values; convert it to uint8, uint16 or float32.")
    kept = np.float32 if image.dtype.type is np.float64 else image.dtype.type
    return cast(Image, np.ascontiguousarray(image, dtype=kept))


def copy_if_writable(image: object, name: str) -> Image:
    """Check an array of grey levels that is kept, and copy it if the caller could still write to it.

    Parameters
    ----------
    image : object
        Image given by the caller.
    name : str
        Name in messages, such as ``"reference"``.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        As from `as_image`; it shares memory with `image` only if that memory is read-only.

    Raises
    ------
    ImageError
        If it is not a 2-D array of one of these types.
    """
    checked = as_image(image, name)
    base: object = checked
    writeable = False
    while isinstance(base, np.ndarray):
        writeable |= base.flags.writeable
        base = base.base
    fixed = not writeable and (base is None or isinstance(base, (bytes, mmap.mmap)))
    return checked if fixed or not np.may_share_memory(checked, cast(Image, image)) else checked.copy()


def validate_deformed(reference: Image, deformed: object) -> Image:
    """Check a deformed image against the reference image.

    Parameters
    ----------
    reference : ndarray, shape (height, width)
        The reference image.
    deformed : object
        Deformed image given by the caller.

    Returns
    -------
    ndarray, shape (height, width)
        The deformed image, as from `as_image`.

    Raises
    ------
    ImageError
        If it is not an image, or not of the size of the reference.
    """
    checked = as_image(deformed, "deformed")
    if checked.shape != reference.shape:
        raise ImageError(
            f"The deformed image is {_size(checked)} and the reference image is {_size(reference)}; "
            "both must come from the same sensor area."
        )
    return checked


def release_pages(image: Image) -> None:
    """Return the memory of an image that is mapped from its file to the system, until it is read again.

    Parameters
    ----------
    image : ndarray
        Any image; does nothing unless it is a read-only memory map.
    """
    base: object = image
    read_only = False
    while isinstance(base, np.ndarray):
        read_only |= isinstance(base, np.memmap) and base.mode == "r"
        base = base.base
    if read_only and isinstance(base, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED"):
        base.madvise(mmap.MADV_DONTNEED)


def _freeze(image: Image) -> None:
    base: object = image
    while isinstance(base, np.ndarray):
        base.flags.writeable = False
        base = base.base


def _size(image: Image) -> str:
    height, width = image.shape
    return f"{width} x {height} px (width x height)"


def _damaged(path: Path) -> ImageError:
    return ImageError(f"{path}: the image file is truncated or damaged; copy or export it again.")


def _decode_with_opencv(path: Path, data: bytes) -> NDArray[Any]:
    import cv2

    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise _damaged(path) from error
    if image is None:
        raise _damaged(path)
    return image


def _decode_tiff(path: Path, *, mapped: bool) -> Image:
    import tifffile

    try:
        with tifffile.TiffFile(path) as tiff:
            pages = [page for page in tiff.pages if isinstance(page, tifffile.TiffPage) and not page.is_reduced]
            pages += [page for page in tiff.pages if not isinstance(page, tifffile.TiffPage)]
            if len(pages) > 1:
                raise ImageError(f"{path}: the TIFF file holds {len(pages)} pages; save each image in its own file.")
            if not pages or not isinstance(page := pages[0], tifffile.TiffPage):
                raise _damaged(path)
            if page.photometric == tifffile.PHOTOMETRIC.PALETTE:
                raise ImageError(f"{path}: the TIFF file has a colour palette; save it as a greyscale image.")
            segments = zip(page.dataoffsets, page.databytecounts, strict=True)
            if any(offset + count > tiff.filehandle.size for offset, count in segments):
                raise _damaged(path)
            try:
                mapped = mapped and page.is_memmappable and page.nbytes >= _MAPPED_BYTES
                image, blue_first = page.asarray(out="memmap" if mapped else None), False
            except ValueError as error:
                if "imagecodecs" not in str(error):
                    raise
                image, blue_first = _decode_with_opencv(path, path.read_bytes()), True
            if not blue_first and page.axes == "SYX":
                image = np.moveaxis(image, 0, -1)
    except ImageError:
        raise
    except Exception as error:  # the decoder raises anything on a damaged file
        raise _damaged(path) from error
    return _to_grey(path, image, blue_first=blue_first)


def _to_grey(path: Path, image: NDArray[Any], *, blue_first: bool) -> Image:
    if image.dtype.type not in (np.uint8, np.uint16, np.float32):
        raise ImageError(f"{path}: the image holds {image.dtype} values; save it in 8 bit, 16 bit or 32-bit float.")
    image = np.ascontiguousarray(image, dtype=image.dtype.type)
    if image.ndim == 3 and image.shape[2] in (3, 4):
        import cv2

        image = np.asarray(
            cv2.cvtColor(image[:, :, :3], cv2.COLOR_BGR2GRAY if blue_first else cv2.COLOR_RGB2GRAY),
            dtype=image.dtype.type,
        )
    elif image.ndim == 3 and image.shape[2] in (1, 2):
        image = np.ascontiguousarray(image[:, :, 0])
    if image.ndim != 2:
        raise ImageError(f"{path}: the image has shape {image.shape}; save it as grey or RGB.")
    return cast(Image, image)


def _png_is_intact(data: bytes) -> bool:
    position = len(_PNG_SIGNATURE)
    while position + 12 <= len(data):
        (length,) = struct.unpack_from(">I", data, position)
        body_end = position + 8 + length
        if body_end + 4 > len(data):
            return False
        (checksum,) = struct.unpack_from(">I", data, body_end)
        if zlib.crc32(memoryview(data)[position + 4 : body_end]) != checksum:
            return False
        if data[position + 4 : position + 8] == b"IEND":
            return True
        position = body_end + 4
    return False


def _jpeg_is_complete(data: bytes) -> bool:
    # Neither marker can occur inside the compressed data, where 0xFF is escaped.
    start_of_scan, end_of_image = b"\xff\xda", b"\xff\xd9"
    return data.rfind(end_of_image) > data.rfind(start_of_scan) > 0


def _bmp_is_complete(data: bytes) -> bool:
    if len(data) < 54:
        return False
    (offset,) = struct.unpack_from("<I", data, 10)
    width, height, _, depth, compression = struct.unpack_from("<iiHHI", data, 18)
    row_bytes = (width * depth + 31) // 32 * 4
    uncompressed = compression in (0, 3)
    return not uncompressed or bool(offset + row_bytes * abs(height) <= len(data))
