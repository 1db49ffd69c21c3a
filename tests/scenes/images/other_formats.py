"""Image files of other formats."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import imagecodecs
import numpy as np
import PIL.Image
from numpy.typing import NDArray

from scenes.images import tiff_writer
from scenes.images.levels import C8, C16, F32, G1, G8, G12, G16, ROUNDING, grey, luminance
from scenes.images.png_writer import png
from scenes.images.variant import Variant, stored


def others() -> Iterator[Variant]:
    def bgr(image: NDArray[Any]) -> NDArray[Any]:
        return np.ascontiguousarray(image[:, :, ::-1]) if image.ndim == 3 else image

    def opencv(name: str, suffix: str, image: NDArray[Any], tolerance: float = 0.0, **options: int) -> Variant:
        truth = luminance(image) if image.ndim == 3 else image
        flags = [item for pair in options.items() for item in (getattr(cv2, pair[0]), pair[1])]
        return Variant(
            suffix[1:].upper().replace("JPG", "JPEG"),
            name,
            suffix,
            lambda path: cv2.imwrite(str(path), bgr(image), flags),
            truth,
            "",
            tolerance,
            "OpenCV",
        )

    def codec(
        form: str,
        name: str,
        suffix: str,
        image: NDArray[Any],
        encode: Callable[[NDArray[Any]], Any],
        tolerance: float = 0.0,
        refusal: str = "",
    ) -> Variant:
        truth = None if refusal else luminance(image) if image.ndim == 3 else image
        return Variant(
            form,
            name,
            suffix,
            lambda path: path.write_bytes(bytes(encode(image))),
            truth,
            refusal,
            tolerance,
            "imagecodecs",
        )

    for image, bits in ((G8, 8), (G16, 16)):
        yield opencv(f"{bits} bit", ".png", image)
        yield codec("JPEG 2000", f"{bits} bit", ".jp2", image, lambda image: imagecodecs.jpeg2k_encode(image, level=0))
        yield codec(
            "JPEG XL", f"{bits} bit", ".jxl", image, lambda image: imagecodecs.jpegxl_encode(image, lossless=True)
        )
        yield codec("JPEG", f"lossless, {bits} bit", ".jpg", image, imagecodecs.ljpeg_encode)
        yield codec("JPEG", f"JPEG-LS, {bits} bit", ".jpg", image, imagecodecs.jpegls_encode)
    yield codec(
        "JPEG 2000",
        "12 bit, codestream",
        ".j2k",
        G12,
        lambda image: imagecodecs.jpeg2k_encode(image, level=0, bitspersample=12, codecformat="j2k"),
    )
    yield codec(
        "JPEG XL",
        "32-bit float",
        ".jxl",
        F32 / F32.max(),
        lambda image: imagecodecs.jpegxl_encode(image, lossless=True),
    )
    for image, bits in ((C8, 8), (C16, 16)):
        yield opencv(f"{bits}-bit RGB", ".png", image, ROUNDING)
        yield codec(
            "JPEG 2000",
            f"{bits}-bit RGB",
            ".jp2",
            image,
            lambda image: imagecodecs.jpeg2k_encode(image, level=0),
            ROUNDING,
        )
        yield codec(
            "JPEG XL",
            f"{bits}-bit RGB",
            ".jxl",
            image,
            lambda image: imagecodecs.jpegxl_encode(image, lossless=True),
            ROUNDING,
        )
    yield from _by_pillow()
    for bits in (2, 4):
        highest = 2**bits - 1
        image = grey(np.uint8, highest)
        rows = b"".join(b"\0" + tiff_writer.raw(row[None], bits, ">") for row in image)
        content = png(image.shape[1], image.shape[0], rows, bits=bits)
        yield Variant("PNG", f"{bits} bit", ".png", stored(content), image * (255 // highest), library="OpenCV")
    yield opencv("8 bit", ".bmp", G8)
    yield opencv("24-bit RGB", ".bmp", C8, ROUNDING)
    yield opencv("8 bit", ".jpg", G8, 4, IMWRITE_JPEG_QUALITY=100)
    yield opencv("8 bit, progressive", ".jpg", G8, 4, IMWRITE_JPEG_QUALITY=100, IMWRITE_JPEG_PROGRESSIVE=1)
    yield codec(
        "JPEG", "12 bit", ".jpg", G12, lambda image: imagecodecs.jpeg_encode(image, level=100, bitspersample=12), 8
    )
    yield codec("WebP", "8-bit RGB", ".webp", C8, lambda image: imagecodecs.webp_encode(image, lossless=True), ROUNDING)
    for letters, image in (("PGM", G8), ("PGM", G12), ("PGM", G16), ("PPM", C8), ("PPM", C16)):
        highest = 2 ** (8 if image is G8 or image is C8 else 12 if image is G12 else 16) - 1
        truth, slack = (image, 0.0) if image.ndim == 2 else (luminance(image), ROUNDING)
        for binary in (True, False):
            number = {"PGM": 5, "PPM": 6}[letters] - (0 if binary else 3)
            head = f"P{number}\n# by a camera\n{image.shape[1]} {image.shape[0]}\n{highest}\n".encode()
            body = (
                image.astype(">u2" if highest > 255 else "u1").tobytes()
                if binary
                else " ".join(map(str, image.ravel())).encode()
            )
            yield Variant(
                letters,
                f"{'binary' if binary else 'text'}, up to {highest}",
                f".{letters.lower()}",
                stored(head + body),
                truth,
                "",
                slack,
                "fedic",
            )
    head = f"{G8.shape[1]} {G8.shape[0]}\n".encode()
    yield Variant(
        "PBM",
        "binary",
        ".pbm",
        stored(b"P4 " + head + np.packbits(~G1, axis=1).tobytes()),
        G1.astype(np.uint8),
        library="fedic",
    )
    yield Variant(
        "PBM",
        "text",
        ".pbm",
        stored(b"P1 " + head + " ".join(map(str, (~G1).ravel().astype(int))).encode()),
        G1.astype(np.uint8),
        library="fedic",
    )
    for order, scale in (("<", b"-1.0"), (">", b"1.0")):
        yield Variant(
            "PFM",
            f"{'little' if order == '<' else 'big'}-endian",
            ".pfm",
            stored(b"Pf\n" + head + scale + b"\n" + F32[::-1].astype(f"{order}f4").tobytes()),
            F32,
            library="fedic",
        )
    for name, array, truth in (
        ("uint8", G8, G8),
        ("big-endian uint16", G16.astype(">u2"), G16),
        ("float32", F32, F32),
        ("float64", F32.astype(float), F32),
        ("int64", G16.astype(np.int64), G16),
        ("Fortran order", np.asfortranarray(G16), G16),
        ("8-bit RGB", C8, luminance(C8)),
    ):
        yield Variant(".npy", name, ".npy", _save(array), truth, "", ROUNDING if array.ndim == 3 else 0.0, "NumPy")
    stack = np.stack([G16, ~G16])
    yield Variant(".npy", "two images, none named", ".npy", _save(stack), None, "holds 2 images", library="NumPy")
    yield Variant(".npy", "two images, #1", ".npy", _save(stack), stack[1], library="NumPy", page="#1")
    yield Variant(
        ".npy",
        "Python objects",
        ".npy",
        lambda path: np.save(path, np.array([[None]]), allow_pickle=True),
        None,
        "Python objects",
        library="NumPy",
    )
    yield Variant(".npy", "complex", ".npy", _save(F32.astype(complex)), None, "complex128", library="NumPy")


def _by_pillow() -> Iterator[Variant]:
    turned = PIL.Image.Exif()
    turned[0x0112] = 6
    ramp = np.random.default_rng(4).permutation(256).astype(np.uint8)
    palette = PIL.Image.fromarray(np.argsort(ramp).astype(np.uint8)[G8], "P")
    palette.putpalette(np.repeat(ramp, 3).tobytes())
    cmyk = PIL.Image.fromarray(np.stack([~G8, ~G8, ~G8, G8 * 0], axis=2), "CMYK")
    both = PIL.Image.fromarray(np.stack([G8, G8 // 2], axis=2), "LA")
    opaque = PIL.Image.fromarray(np.stack([G8, G8, G8, ~G8], axis=2), "RGBA")
    black_white = PIL.Image.fromarray(G1)
    grey_image = PIL.Image.fromarray(G8)
    for form, name, picture, truth, tolerance, options in (
        ("PNG", "1 bit", black_white, G1 * np.uint8(255), 0, {}),
        ("PNG", "grey palette", palette, G8, 0, {}),
        ("PNG", "grey and alpha", both, G8, 0, {}),
        ("PNG", "EXIF orientation 6", grey_image, G8, 0, {"exif": turned}),
        ("BMP", "1 bit", black_white, G1 * np.uint8(255), 0, {}),
        ("BMP", "grey palette", palette, G8, 0, {}),
        ("BMP", "32 bit", opaque, G8, 0, {}),
        ("JPEG", "EXIF orientation 6", grey_image, G8, 4, {"quality": 100, "exif": turned}),
        ("JPEG", "CMYK", cmyk, G8, 6, {"quality": 100}),
        ("WebP", "EXIF orientation 6", grey_image, G8, ROUNDING, {"lossless": True, "exif": turned}),
    ):
        suffix = f".{form.lower()}"
        library = "imagecodecs" if form == "WebP" else "OpenCV"
        yield Variant(form, name, suffix, partial(picture.save, **options), truth, "", tolerance, library)


def _save(array: NDArray[Any]) -> Callable[[Path], object]:
    return lambda path: np.save(path, array)


def foreign() -> Iterator[Variant]:
    for form, content, suffix, refusal in (
        ("GIF", b"GIF89a", ".gif", "a GIF image"),
        ("OpenEXR", b"\x76\x2f\x31\x01", ".exr", "an OpenEXR image"),
        ("AVI", b"RIFF\0\0\0\0AVI LIST", ".avi", "an AVI video"),
        ("MP4", b"\0\0\0\x18ftypisom", ".mp4", "MP4 or QuickTime video"),
        ("HEIC", b"\0\0\0\x18ftypheic", ".heic", "a HEIC image"),
        ("Phantom cine", b"CI\x2c\0", ".cine", "a Phantom cine recording"),
        ("raw samples", b"\1\2\3\4", ".raw", "raw samples"),
        ("Canon raw", b"II*\0\x10\0\0\0CR\2\0", ".cr2", "a Canon raw image"),
        ("NumPy archive", b"PK\3\4", ".npz", "a zip archive"),
        ("HDF5", b"\x89HDF\r\n\x1a\n", ".h5", "an HDF5 file"),
        ("MATLAB", b"MATLAB 5.0 MAT-file", ".mat", "a MATLAB file"),
        ("text", b"no image", ".png", "is not supported; convert it"),
    ):
        yield Variant(form, "any", suffix, stored(content.ljust(600, b"\0")), None, refusal, library="")
