"""A plain writer of TIFF files, which states every tag, so that right and wrong files of any kind can be made."""

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import imagecodecs
import numpy as np
from numpy.typing import NDArray

Tags = Mapping[int, tuple[str, Sequence[int | float]]]
_TYPES = {"B": 1, "s": 2, "H": 3, "I": 4, "rational": 5, "Q": 16}
_FORMATS = {"unsigned": 1, "signed": 2, "float": 3}


@dataclass(frozen=True)
class Page:
    """A directory, its strips or tiles as they are in the file, and its subordinate directories."""

    tags: Tags
    segments: Sequence[bytes]
    tiled: bool = False
    sub: Sequence["Page"] = field(default=())


def write(pages: Sequence[Page], *, order: str = "<", big: bool = False) -> bytes:
    """Return a TIFF file of some pages."""
    offset_type = "Q" if big else "I"
    out = bytearray((b"II" if order == "<" else b"MM") + struct.pack(f"{order}H", 43 if big else 42))
    if big:
        out += struct.pack(f"{order}HH", 8, 0)
    link = len(out)
    out += bytes(struct.calcsize(offset_type))
    for page in pages:
        offset, end = _append(out, page, order, big)
        struct.pack_into(f"{order}{offset_type}", out, link, offset)
        link = end
    return bytes(out)


def _append(out: bytearray, page: Page, order: str, big: bool) -> tuple[int, int]:
    """Append a page; return the place of its directory and that of the link to the next one."""
    offset_type = "Q" if big else "I"
    tags = dict(page.tags)
    if page.sub:
        tags[330] = (offset_type, [_append(out, sub, order, big)[0] for sub in page.sub])
    offsets = []
    for segment in page.segments:
        out += bytes(-len(out) % 16)
        offsets.append(len(out))
        out += segment
    where, size = (324, 325) if page.tiled else (273, 279)
    tags.setdefault(where, (offset_type, offsets))
    tags.setdefault(size, (offset_type, [len(segment) for segment in page.segments]))
    entries = []
    for code in sorted(tags):
        kind, values = tags[code]
        data = (
            b"".join(struct.pack(f"{order}II", *np.float64(v).as_integer_ratio()) for v in values)
            if kind == "rational"
            else struct.pack(f"{order}{len(values)}{'B' if kind == 's' else kind}", *values)
        )
        room = 8 if big else 4
        if len(data) > room:
            out += bytes(-len(out) % 2)
            place = len(out)
            out += data
            data = struct.pack(f"{order}{offset_type}", place)
        entries.append(
            struct.pack(f"{order}HH{offset_type}", code, _TYPES[kind], len(values)) + data.ljust(room, b"\0")
        )
    out += bytes(-len(out) % 2)
    place = len(out)
    out += struct.pack(f"{order}{'Q' if big else 'H'}", len(entries)) + b"".join(entries)
    link = len(out)
    out += bytes(struct.calcsize(offset_type))
    return place, link


def raw(data: NDArray[Any], bits: int, order: str) -> bytes:
    """Return the bytes of rows of samples, packed if they have not whole bytes."""
    if bits % 8 == 0 and bits // 8 == data.dtype.itemsize:
        return data.astype(data.dtype.newbyteorder(order)).tobytes()
    digits = (data.reshape(len(data), -1, 1).astype(np.uint32) >> np.arange(bits - 1, -1, -1, dtype=np.uint32)) & 1
    return np.packbits(digits.reshape(len(data), -1).astype(np.uint8), axis=1).tobytes()


def _jpeg(data: NDArray[Any], bits: int, order: str) -> bytes:
    return bytes(imagecodecs.jpeg_encode(np.squeeze(data), level=100, bitspersample=bits))


def _bytewise(encode: Callable[..., Any]) -> Callable[[NDArray[Any], int, str], bytes]:
    return lambda data, bits, order: bytes(encode(raw(data, bits, order)))


def _imagewise(encode: Callable[..., Any], **options: Any) -> Callable[[NDArray[Any], int, str], bytes]:
    return lambda data, bits, order: bytes(
        encode(np.ascontiguousarray(np.squeeze(data, axis=2) if data.shape[2] == 1 else data), **options)
    )


COMPRESSIONS: dict[str, tuple[int, Callable[[NDArray[Any], int, str], bytes]]] = {
    "none": (1, raw),
    "LZW": (5, _bytewise(imagecodecs.lzw_encode)),
    "deflate": (8, _bytewise(imagecodecs.zlib_encode)),
    "PackBits": (32773, _bytewise(imagecodecs.packbits_encode)),
    "ZSTD": (50000, _bytewise(imagecodecs.zstd_encode)),
    "LZMA": (34925, _bytewise(imagecodecs.lzma_encode)),
    "JPEG": (7, _jpeg),
    "JPEG 2000": (34712, _imagewise(imagecodecs.jpeg2k_encode, level=0)),
    "JPEG XL": (50002, _imagewise(imagecodecs.jpegxl_encode, lossless=True)),
    "LERC": (34887, _imagewise(imagecodecs.lerc_encode)),
    "PNG": (34933, _imagewise(imagecodecs.png_encode)),
    "WebP": (50001, _imagewise(imagecodecs.webp_encode, lossless=True)),
}


def page(
    image: NDArray[Any],
    *,
    bits: int = 0,
    compression: str = "none",
    predictor: int = 1,
    planar: bool = False,
    tile: int = 0,
    rows: int = 0,
    order: str = "<",
    photometric: int | None = None,
    tags: Tags | None = None,
    sub: Sequence[Page] = (),
) -> Page:
    """Return a page of an image of shape (height, width) or (height, width, samples)."""
    samples = image[:, :, None] if image.ndim == 2 else image
    height, width, count = samples.shape
    bits = bits or samples.dtype.itemsize * 8
    kind = "float" if samples.dtype.kind == "f" else "signed" if samples.dtype.kind == "i" else "unsigned"
    code, encode = COMPRESSIONS[compression]
    tall, wide = (tile, tile) if tile else (rows or height, width)
    segments = []
    for plane in np.moveaxis(samples, 2, 0)[:, :, :, None] if planar else samples[None]:
        for top in range(0, height, tall):
            for left in range(0, width, wide):
                part = plane[top : top + tall, left : left + wide]
                if tile:
                    part = np.pad(part, ((0, tall - part.shape[0]), (0, wide - part.shape[1]), (0, 0)), mode="edge")
                if predictor == 2:
                    part = np.concatenate([part[:, :1], np.diff(part, axis=1)], axis=1)
                if predictor == 3:
                    swapped = imagecodecs.floatpred_encode(part.astype(part.dtype.newbyteorder(order)), axis=-2)
                    segments.append(
                        bytes(
                            {"LZW": imagecodecs.lzw_encode, "deflate": imagecodecs.zlib_encode}[compression](
                                swapped.tobytes()
                            )
                        )
                    )
                else:
                    segments.append(encode(part, bits, order))
    stated: dict[int, tuple[str, Sequence[int | float]]] = {
        256: ("I", [width]),
        257: ("I", [height]),
        258: ("H", [bits] * count),
        259: ("H", [code]),
        262: ("H", [(2 if count > 2 else 1) if photometric is None else photometric]),
        277: ("H", [count]),
        284: ("H", [2 if planar else 1]),
        317: ("H", [predictor]),
        339: ("H", [_FORMATS[kind]] * count),
    }
    extra = count - (3 if stated[262][1][0] in (2, 6) else 1)
    if extra > 0:
        stated[338] = ("H", [2] * extra)
    stated |= {322: ("I", [tile]), 323: ("I", [tile])} if tile else {278: ("I", [tall])}
    stated |= tags or {}
    return Page({code: tag for code, tag in stated.items() if tag[1]}, segments, bool(tile), sub)
