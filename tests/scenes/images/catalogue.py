"""All image files."""

from collections.abc import Iterator

from scenes.images import other_formats, tiff_colours, tiff_pages, tiff_samples
from scenes.images.variant import Variant


def variants() -> Iterator[Variant]:
    """Yield all files."""
    yield from tiff_samples.depths()
    yield from tiff_samples.compressions()
    yield from tiff_samples.layouts()
    yield from tiff_colours.photometric()
    yield from tiff_pages.pages()
    yield from tiff_colours.refused()
    yield from other_formats.others()
    yield from other_formats.foreign()
