"""TIFF files of many depths, compressions and layouts."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import imagecodecs
import numpy as np
import PIL.Image
from numpy.typing import NDArray

from scenes.images import tiff_writer
from scenes.images.levels import C8, C16, F32, G1, G8, G12, G16, ROUNDING, grey, luminance
from scenes.images.variant import Variant, tiff


def depths() -> Iterator[Variant]:
    for bits in (1, 2, 4, 6, 8, 10, 12, 14, 16):
        image = grey(np.uint8 if bits <= 8 else np.uint16, 2**bits - 1)
        yield tiff(f"{bits} bit", image, image, bits=bits)
        if bits not in (8, 16):
            yield tiff(
                f"{bits} bit, big-endian, LZW, strips", image, image, bits=bits, compression="LZW", rows=8, order=">"
            )
    yield tiff("32-bit integers up to 65535", G16.astype(np.uint32), G16)
    yield tiff("32-bit integers up to 1e6", G16.astype(np.uint32) * 15, (G16.astype(np.uint32) * 15).astype(np.float32))
    yield tiff("32-bit integers up to 4e9", G16.astype(np.uint32) * 65537, None, refusal="cannot hold exactly")
    yield tiff("signed 8 bit", G8.astype(np.int8), G8.astype(np.int8).astype(np.float32))
    yield tiff("signed 16 bit, none negative", G12.astype(np.int16), G12)
    yield tiff("signed 16 bit, some negative", G12.astype(np.int16) - 9, (G12.astype(np.int16) - 9).astype(np.float32))
    yield tiff("16-bit float", F32.astype(np.float16), F32.astype(np.float16).astype(np.float32))
    yield tiff("32-bit float", F32, F32)
    yield tiff("64-bit float", F32.astype(np.float64), F32)
    yield tiff("64-bit float beyond 1e39", F32 * np.float64(1e39), None, refusal="beyond 3.4e38")
    yield tiff("complex", F32.astype(np.complex64), None, refusal="complex64", tags={339: ("H", [6])})


def compressions() -> Iterator[Variant]:
    for name in tiff_writer.COMPRESSIONS:
        for image, bits in ((G8, 8), (G16, 16), (G12, 12)):
            if (name, bits) in (("WebP", 8), ("WebP", 16), ("WebP", 12), ("JPEG", 16)) or (
                bits == 12 and name != "JPEG"
            ):
                continue
            yield tiff(
                f"{bits} bit, {name}",
                image,
                image,
                bits=bits,
                compression=name,
                rows=16,
                tolerance=4 if name == "JPEG" else 0,
            )
    for name in ("LZW", "deflate", "PackBits", "ZSTD", "LZMA", "LERC", "JPEG XL"):
        yield tiff(f"32-bit float, {name}", F32, F32, compression=name)
    yield tiff("8-bit RGB, WebP", C8, luminance(C8), compression="WebP", tolerance=ROUNDING)
    yield tiff("8-bit YCbCr, JPEG", C8, luminance(C8), compression="JPEG", photometric=6, tolerance=6)
    for name in ("tiff_ccitt", "group3", "group4"):
        yield Variant("TIFF", f"1 bit, {name} of Pillow", ".tif", _by_pillow(name), G1.astype(np.uint8))


def _by_pillow(compression: str) -> Callable[[Path], object]:
    return lambda path: PIL.Image.fromarray(G1).save(path, compression=compression)


def _raw(name: str, page: tiff_writer.Page, truth: NDArray[Any] | None, refusal: str = "") -> Variant:
    return Variant("TIFF", name, ".tif", lambda path: path.write_bytes(tiff_writer.write([page])), truth, refusal)


def layouts() -> Iterator[Variant]:
    for big, order in ((False, "<"), (False, ">"), (True, "<"), (True, ">")):
        kind = f"{'BigTIFF' if big else 'classic'}, {'little' if order == '<' else 'big'}-endian"
        for compression in ("none", "LZW", "deflate"):
            for tile in (0, 16):
                layout = "tiles" if tile else "strips"
                options: dict[str, Any] = {
                    "big": big,
                    "order": order,
                    "compression": compression,
                    "tile": tile,
                    "rows": 7,
                }
                yield tiff(f"16 bit, {kind}, {compression}, {layout}", G16, G16, **options)
                yield tiff(
                    f"planar 16-bit RGB, {kind}, {compression}, {layout}",
                    C16,
                    luminance(C16),
                    planar=True,
                    tolerance=ROUNDING,
                    **options,
                )
    for image, bits in ((G8, 8), (G16, 16)):
        for compression in ("LZW", "deflate", "ZSTD"):
            for order in "<>":
                yield tiff(
                    f"{bits} bit, {compression}, horizontal predictor, {'little' if order == '<' else 'big'}-endian",
                    image,
                    image,
                    compression=compression,
                    predictor=2,
                    order=order,
                    rows=8,
                )
    for dtype in (np.float16, np.float32, np.float64):
        image = F32.astype(dtype)
        yield tiff(
            f"{image.itemsize * 8}-bit float, deflate, floating-point predictor",
            image,
            image.astype(np.float32),
            compression="deflate",
            predictor=3,
        )
    yield tiff(
        "8-bit RGB, LZW, horizontal predictor", C8, luminance(C8), compression="LZW", predictor=2, tolerance=ROUNDING
    )
    flipped = tiff_writer.page(G8, tags={266: ("H", [2])})
    yield _raw(
        "8 bit, bits of each byte reversed",
        tiff_writer.Page(flipped.tags, [imagecodecs.bitorder_encode(flipped.segments[0])]),
        G8,
    )
