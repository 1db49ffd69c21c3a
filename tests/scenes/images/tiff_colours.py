"""TIFF files of many photometric interpretations, and those refused."""

from collections.abc import Iterator

import numpy as np

from scenes.images.levels import C8, C16, F32, G8, G16, ROUNDING, grey, luminance
from scenes.images.variant import Variant, tiff


def photometric() -> Iterator[Variant]:
    for compression in ("none", "LZW", "deflate", "PackBits", "JPEG 2000"):
        for bits in (8, 16):
            image = G8 if bits == 8 else G16
            yield tiff(f"white is 0, {bits} bit, {compression}", ~image, image, photometric=0, compression=compression)
    for bits in (1, 4, 12):
        image = grey(np.uint8 if bits < 8 else np.uint16, 2**bits - 1)
        yield tiff(f"white is 0, {bits} bit", image.dtype.type(2**bits - 1) - image, image, photometric=0, bits=bits)
    yield tiff("white is 0, 32-bit float", F32, None, photometric=0, refusal="MINISWHITE")
    ramp = np.arange(256)
    shuffled = np.random.default_rng(3).permutation(256)
    back = np.argsort(shuffled).astype(np.uint8)
    for name, palette in (("times 257", shuffled * 257), ("times 256", shuffled * 256), ("8-bit values", shuffled)):
        yield tiff(f"grey palette, {name}", back[G8], G8, photometric=3, tags={320: ("H", [*palette] * 3)})
    deep = ramp * 251 + 3
    yield tiff(
        "grey palette, 16-bit values, LZW",
        G8,
        deep.astype(np.uint16)[G8],
        photometric=3,
        compression="LZW",
        tags={320: ("H", [*deep] * 3)},
    )
    table = np.stack([ramp, ramp[::-1], shuffled], axis=1)
    yield tiff(
        "colour palette",
        G8,
        luminance(table[G8]),
        photometric=3,
        tolerance=ROUNDING,
        tags={320: ("H", [*(table.T.ravel() * 257)])},
    )
    small = grey(np.uint8, 15)
    yield tiff(
        "grey palette, 4 bit", small, small * 17, bits=4, photometric=3, tags={320: ("H", [*range(0, 65536, 4369)] * 3)}
    )
    for orientation in range(2, 9):
        yield tiff(
            f"orientation tag {orientation}",
            G8,
            G8,
            tags={274: ("H", [orientation])},
            compression="LZW" if orientation % 2 else "none",
        )
    for compression in ("none", "LZW"):
        zero = np.concatenate([C8, np.zeros_like(C8[:, :, :1])], axis=2)
        yield tiff(
            f"8-bit RGB, alpha 0, {compression}", zero, luminance(C8), compression=compression, tolerance=ROUNDING
        )
        five = np.concatenate([C8, C8[:, :, ::2]], axis=2)
        yield tiff(
            f"8-bit RGB and 2 extra samples, {compression}", five, luminance(C8), compression=compression, tolerance=1
        )
        yield tiff(f"16-bit grey and alpha, {compression}", np.stack([G16, ~G16], axis=2), G16, compression=compression)
    yield tiff("8-bit YCbCr, uncompressed", C8, C8[:, :, 0], photometric=6, tags={530: ("H", [1, 1])})
    yield tiff("no photometric tag, grey", G8, G8, tags={262: ("H", [])})
    yield tiff("no photometric tag, RGB", C8, luminance(C8), tags={262: ("H", [])}, tolerance=ROUNDING)
    yield tiff("16-bit RGB", C16, luminance(C16), tolerance=ROUNDING)
    floats = C16.astype(np.float32) / 7
    yield tiff("32-bit float RGB", floats, luminance(floats), tolerance=0.01)


def refused() -> Iterator[Variant]:
    four = np.concatenate([C8, C8[:, :, :1]], axis=2)
    yield tiff("CMYK", four, None, photometric=5, tags={338: ("H", [])}, refusal="SEPARATED")
    yield tiff("CIELAB", C8, None, photometric=8, tags={338: ("H", [])}, refusal="CIELAB")
    yield tiff("colour filter array", G16, None, photometric=32803, refusal="CFA")
    yield tiff("linear raw", C16, None, photometric=34892, tags={338: ("H", [])}, refusal="LINEAR_RAW")
    yield tiff("LogLuv", F32, None, photometric=32844, refusal="LOGL")
    yield tiff("grey, three undeclared samples", C8, None, photometric=1, tags={338: ("H", [])}, refusal="needs 1")
    yield tiff("obsolete JPEG", G8, None, tags={259: ("H", [6])}, refusal="OJPEG (6), is not read")
    yield tiff("unknown compression", G8, None, tags={259: ("H", [60000])}, refusal="unknown (60000), is not read")
    yield tiff("unknown predictor", G8, None, compression="LZW", tags={317: ("H", [34892])}, refusal="predictor, ")
    yield tiff("volume", G8, None, tags={32997: ("I", [5])}, refusal="volume of 5 slices")
    yield tiff("RGB of 5, 6 and 5 bits", C8, None, tags={258: ("H", [5, 6, 5])}, refusal="bits")
