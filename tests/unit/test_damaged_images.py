"""Image files that are cut, damaged, or no files at all are refused, and reading them ends at once."""

import os
import struct
from pathlib import Path
from typing import Any

import imagecodecs
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import fedic
from scenes.images import tiff_writer
from scenes.images.catalogue import variants
from scenes.images.levels import C8, G8, G16
from scenes.images.png_writer import png
from scenes.images.variant import Variant

READ = [variant for variant in variants() if variant.truth is not None]
DAMAGED = "truncated or damaged"


def ends_in_text(variant: Variant) -> bool:
    """Whether the last sample is a number in text, of which a digit may be missing."""
    return variant.format in ("PGM", "PPM") and variant.name.startswith("text")


@pytest.mark.parametrize("kept", [0.02, 0.3, 0.6, 0.9, 0.99])
def test_files_cut_anywhere_are_refused_or_unchanged(tmp_path: Path, kept: float) -> None:
    for variant in READ:
        path = tmp_path / f"image{variant.suffix}"
        variant.write(path)
        data = path.read_bytes()
        path.write_bytes(data[: int(kept * len(data))])
        try:
            read = fedic.read_image(f"{path}{variant.page}")
        except fedic.ImageError:
            continue
        np.testing.assert_allclose(read, variant.truth, rtol=0, atol=variant.tolerance, err_msg=variant.name)


def test_files_without_their_last_byte_are_refused(tmp_path: Path) -> None:
    for variant in READ:
        path = tmp_path / f"image{variant.suffix}"
        variant.write(path)
        path.write_bytes(path.read_bytes()[:-1])
        # A named page of a stack may lie before the cut.
        if not variant.page and not ends_in_text(variant):
            with pytest.raises(fedic.ImageError):
                fedic.read_image(path)


@settings(max_examples=300, deadline=5000, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_files_with_changed_bytes_give_an_image_or_an_error(tmp_path: Path, data: st.DataObject) -> None:
    variant = data.draw(st.sampled_from(READ))
    path = tmp_path / f"image{variant.suffix}"
    variant.write(path)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 8))):
        near_an_end = data.draw(st.integers(-min(400, len(content)), min(200, len(content)) - 1))
        content[near_an_end] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    try:
        read = fedic.read_image(f"{path}{variant.page}")
    except fedic.ImageError:
        return
    assert read.ndim == 2
    assert read.dtype.type in (np.uint8, np.uint16, np.float32)


def refused(tmp_path: Path, content: bytes, reason: str = DAMAGED, name: str = "image.tif", page: str = "") -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(fedic.ImageError, match=reason):
        fedic.read_image(f"{tmp_path / name}{page}")


@pytest.mark.parametrize("compression", ["none", "LZW", "deflate", "PackBits", "JPEG 2000"])
@pytest.mark.parametrize("tile", [0, 16])
def test_tiff_with_missing_or_displaced_parts_is_refused(tmp_path: Path, compression: str, tile: int) -> None:
    page = tiff_writer.page(G8, compression=compression, tile=tile, rows=9)
    where, size = (324, 325) if tile else (273, 279)
    count = len(page.segments)

    def changed(segments: list[bytes], **tags: Any) -> bytes:
        fields = {int(code[1:]): ("I", values) for code, values in tags.items()}
        return tiff_writer.write([tiff_writer.Page({**page.tags, **fields}, segments, bool(tile))])

    whole = changed([*page.segments])
    (tmp_path / "whole.tif").write_bytes(whole)
    np.testing.assert_array_equal(fedic.read_image(tmp_path / "whole.tif"), G8)
    refused(tmp_path, changed([*page.segments[:-1]]), "that its size needs")
    sizes = [len(segment) for segment in page.segments]
    starts = [whole.index(segment) for segment in page.segments]
    refused(tmp_path, changed([*page.segments], **{f"t{where}": [0, *starts[1:]]}), "missing")
    refused(tmp_path, changed([*page.segments], **{f"t{size}": [0, *sizes[1:]]}), "missing")
    refused(tmp_path, changed([*page.segments], **{f"t{where}": [*starts[1:], len(whole) + 99]}), "beyond its end")
    refused(tmp_path, changed([*page.segments[:-1], page.segments[-1][: len(page.segments[-1]) // 2]]))
    assert count > 1
    refused(tmp_path, changed([*page.segments], **{"t323" if tile else "t278": [0]}), "have no rows")


def test_damaged_lzw_is_refused_unless_it_decodes_to_the_same_length(tmp_path: Path) -> None:
    """LZW has no checksum; of one changed byte, most change the length or make a code that does not exist."""
    page = tiff_writer.page(G8, compression="LZW")
    rng = np.random.default_rng(0)
    accepted = 0
    for _ in range(200):
        strip = bytearray(page.segments[0])
        strip[rng.integers(len(strip))] ^= int(rng.integers(1, 256))
        (tmp_path / "lzw.tif").write_bytes(tiff_writer.write([tiff_writer.Page(page.tags, [bytes(strip)])]))
        try:
            fedic.read_image(tmp_path / "lzw.tif")
        except fedic.ImageError:
            continue
        accepted += 1
        assert len(imagecodecs.lzw_decode(bytes(strip))) == G8.size
    assert accepted < 80  # docs/images.md: three of five are found


def test_tiff_that_holds_another_type_than_it_states_is_refused(tmp_path: Path) -> None:
    deep = tiff_writer.page(G16, compression="JPEG 2000")
    refused(tmp_path, tiff_writer.write([tiff_writer.Page({**deep.tags, 258: ("H", [8])}, deep.segments)]))
    cut = tiff_writer.page(G8, compression="JPEG")
    refused(tmp_path, tiff_writer.write([tiff_writer.Page(cut.tags, [cut.segments[0][:-500]])]))


def chain(count: int, *, circle: bool = False) -> bytes:
    """Return a TIFF file of many directories of one tag each."""
    entry = struct.pack("<HHHII", 1, 256, 4, 1, 50)
    places = [8 + 18 * index for index in range(count)]
    links = [*places[1:], places[0] if circle else 0]
    return b"II*\0" + struct.pack("<I", 8) + b"".join(entry + struct.pack("<I", link) for link in links)


def test_lists_of_pages_that_do_not_end_are_refused(tmp_path: Path) -> None:
    refused(tmp_path, chain(3, circle=True), "runs in a circle")
    refused(tmp_path, chain(10_001), "lists more than 10000 pages")
    refused(tmp_path, chain(1000), "holds 1000 pages")
    first = tiff_writer.page(G8)
    refused(tmp_path, tiff_writer.write([first, first])[:-4], DAMAGED)
    whole = tiff_writer.write([first, tiff_writer.page(G16)])
    for end in range(len(tiff_writer.write([first])), len(whole), 50):
        refused(tmp_path, whole[:end])


def test_a_stack_of_one_directory_that_is_cut_is_refused(tmp_path: Path) -> None:
    text = b"ImageJ=1.53\nimages=3\nslices=3\n\0"
    page = tiff_writer.page(G8, tags={270: ("s", list(text))})
    three = tiff_writer.Page({**page.tags, 279: ("I", [G8.size])}, [G8.tobytes() * 3])
    (tmp_path / "stack.tif").write_bytes(tiff_writer.write([three]))
    np.testing.assert_array_equal(fedic.read_image(f"{tmp_path / 'stack.tif'}#2"), G8)
    two = tiff_writer.Page(three.tags, [G8.tobytes() * 2])
    refused(tmp_path, tiff_writer.write([two]), "should hold 3 images, and ends after 2")
    # The description of a stack beside one image.
    (tmp_path / "one.tif").write_bytes(tiff_writer.write([page]))
    np.testing.assert_array_equal(fedic.read_image(tmp_path / "one.tif"), G8)


def test_a_stack_of_metamorph_lists_one_directory_for_all_planes(tmp_path: Path) -> None:
    planes = np.stack([G8, ~G8, G8[::-1]])
    page = tiff_writer.page(G8, tags={33628: ("I", [0, 0]), 33629: ("rational", [1] * 9), 279: ("I", [G8.size])})
    content = tiff_writer.write([tiff_writer.Page(page.tags, [planes.tobytes()])])
    # The tag states the number of planes, each of which has three times as much data as usual for its type.
    content = content.replace(struct.pack("<HHI", 33629, 5, 9), struct.pack("<HHI", 33629, 5, 3))
    refused(tmp_path, content, "holds 3 pages", "image.stk")
    for number, plane in enumerate(planes):
        np.testing.assert_array_equal(fedic.read_image(f"{tmp_path / 'image.stk'}#{number}"), plane)


def test_images_that_would_decode_to_more_than_4_gib_are_refused_before_decoding(tmp_path: Path) -> None:
    limit = "more than the 4 GiB"
    refused(tmp_path, png(100_000, 100_000, b""), limit, "image.png")
    refused(tmp_path, b"P5 100000 100000 255\n", limit, "image.pgm")
    wide = tiff_writer.page(G8, compression="LZW", tags={code: ("I", [100_000]) for code in (256, 257, 278)})
    refused(tmp_path, tiff_writer.write([wide]), limit)
    row = tiff_writer.page(np.zeros((1, 1 << 20), np.uint8), tags={257: ("I", [5000]), 278: ("I", [1])})
    repeated = {**row.tags, 273: ("I", [16] * 5000), 279: ("I", [1 << 20] * 5000)}
    refused(tmp_path, tiff_writer.write([tiff_writer.Page(repeated, row.segments)]), limit)
    for name, data, place in (
        ("image.j2k", imagecodecs.jpeg2k_encode(G8, codecformat="j2k"), 8),
        ("image.bmp", struct.pack("<2sIHHIIIIHHI", b"BM", 0, 0, 0, 54, 40, 0, 0, 1, 24, 0).ljust(99, b"\0"), 18),
    ):
        content = bytearray(data)
        struct.pack_into("<II" if name.endswith("bmp") else ">II", content, place, 100_000, 100_000)
        refused(tmp_path, bytes(content), limit, name)
    jpeg = bytearray(imagecodecs.jpeg_encode(np.dstack([G16 >> 4] * 3), bitspersample=12))
    struct.pack_into(">HH", jpeg, jpeg.index(b"\xff\xc1") + 5, 65500, 65500)
    refused(tmp_path, bytes(jpeg), limit, "image.jpg")
    strip = tiff_writer.page(C8, compression="JPEG")
    refused(tmp_path, tiff_writer.write([tiff_writer.Page(strip.tags, [bytes(jpeg)])]), limit)
    # Large images of JPEG XL begin with these sizes: two bits for the number of bits, then 30 of them.
    bits = 0 | (3 << 1) | (99_999 << 3) | (0 << 33) | (3 << 36) | (99_999 << 38)
    refused(tmp_path, b"\xff\x0a" + bits.to_bytes(9, "little"), limit, "image.jxl")


def test_images_without_pixels_and_animations_are_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "none.npy", np.zeros((0, 5), np.uint8))
    refused(tmp_path, (tmp_path / "none.npy").read_bytes(), "no pixels", "none.npy")
    rows = b"".join(b"\0" + row.tobytes() for row in G8)
    refused(tmp_path, png(61, 45, rows, animation=struct.pack(">II", 2, 0)), "animated PNG", "image.png")
    frames = imagecodecs.webp_encode(np.dstack([G8] * 3), lossless=True)
    animated = b"RIFF" + struct.pack("<I", 26) + b"WEBPVP8X" + struct.pack("<I", 10) + b"\x02" + bytes(9) + frames
    refused(tmp_path, animated, "animated WebP", "image.webp")
    refused(tmp_path, b"P5 2 1 255\n\x01\x02P5 2 1 255\n\x01\x02", "more than one image", "image.pgm")
    refused(tmp_path, b"P2 2 1 9\n1 12", DAMAGED, "image.pgm")


@pytest.mark.skipif(os.name != "posix", reason="FIFOs and device files are those of POSIX")
def test_folders_pipes_and_devices_are_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.tif")
    with pytest.raises(fedic.ImageError, match="this is a device or a pipe"):
        fedic.read_image(tmp_path / "pipe.tif")
    with pytest.raises(fedic.ImageError, match="this is a device or a pipe"):
        fedic.read_image("/dev/zero")
    with pytest.raises(fedic.ImageError, match="this is a folder"):
        fedic.read_image(tmp_path)


@pytest.mark.parametrize("name", ["a\0b.tif", "a\0b.tif#1", "x" * 5000, None, 3])
def test_names_that_no_file_can_have_are_refused(name: Any) -> None:
    with pytest.raises(fedic.ImageError):
        fedic.read_image(name)
