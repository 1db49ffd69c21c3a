"""Image files read as grey levels, and checks of images given as arrays."""

from fedic.io.images.arrays import as_image, copy_if_writable, release_pages, validate_deformed
from fedic.io.images.mean import mean_image
from fedic.io.images.page_names import image_stem, split_page
from fedic.io.images.reader import read_image

__all__ = [
    "as_image",
    "copy_if_writable",
    "image_stem",
    "mean_image",
    "read_image",
    "release_pages",
    "split_page",
    "validate_deformed",
]
