"""TIFF files of several pages."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import tifffile
from numpy.typing import NDArray

from scenes.images import tiff_writer
from scenes.images.levels import G1, G8, G16
from scenes.images.variant import Variant


def pages() -> Iterator[Variant]:
    def file(
        name: str,
        pages: list[tiff_writer.Page],
        truth: NDArray[Any] | None,
        page: str = "",
        refusal: str = "",
        **options: Any,
    ) -> Variant:
        return Variant(
            "TIFF",
            name,
            ".tif",
            lambda path: path.write_bytes(tiff_writer.write(pages, **options)),
            truth,
            refusal,
            page=page,
        )

    thumbnail = tiff_writer.page(G8[::4, ::4], tags={254: ("I", [1])})
    mask = tiff_writer.page(G1.astype(np.uint8), bits=1, photometric=4, tags={254: ("I", [4])})
    full, other = tiff_writer.page(G8, compression="LZW"), tiff_writer.page(G16, rows=9)
    yield file("thumbnail before the image", [thumbnail, full], G8)
    yield file("thumbnail and mask after the image", [full, thumbnail, mask], G8)
    yield file(
        "thumbnail, the image subordinate to it",
        [tiff_writer.page(G8[::4, ::4], tags={254: ("I", [1])}, sub=[full])],
        G8,
    )
    yield file(
        "reduced images subordinate to the image", [tiff_writer.page(G8, sub=[thumbnail, thumbnail])], G8, big=True
    )
    yield file("old tag of thumbnails", [tiff_writer.page(G8[::4, ::4], tags={255: ("H", [2])}), full], G8)
    yield file("three pages, none named", [full, other, full], None, refusal="holds 3 pages")
    yield file("three pages, #1", [full, other, full], G16, "#1")
    yield file("three pages, #2", [full, other, full], G8, "#2", order="<", big=True)
    yield file("three pages, #3", [full, other, full], None, "#3", refusal="page 3 does not exist")
    yield file("one page, #0", [other], G16, "#0")
    stack = np.stack([G16, ~G16, G16[::-1]])
    for name, write in (
        ("ImageJ stack", lambda path: tifffile.imwrite(path, stack, imagej=True)),
        ("ImageJ stack of one directory", lambda path: tifffile.imwrite(path, stack, imagej=True, truncate=True)),
        ("stack of one directory", lambda path: tifffile.imwrite(path, stack, photometric="minisblack", truncate=True)),
        ("OME stack", lambda path: tifffile.imwrite(path, stack, ome=True, photometric="minisblack")),
    ):
        yield Variant("TIFF", f"{name}, none named", ".tif", write, None, "holds 3 pages")
        yield Variant("TIFF", f"{name}, #2", ".tif", write, stack[2], page="#2")
