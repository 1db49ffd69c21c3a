"""What a file is, how it is written, and what reading it must give."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from scenes.images import tiff_writer


@dataclass(frozen=True)
class Variant:
    """One file: what it is, how to write it, and what reading it must give."""

    format: str
    name: str
    suffix: str
    write: Callable[[Path], object]
    truth: NDArray[Any] | None
    refusal: str = ""
    tolerance: float = 0.0
    library: str = "tifffile, imagecodecs"
    page: str = ""


def tiff(
    name: str,
    image: NDArray[Any],
    truth: NDArray[Any] | None,
    *,
    tolerance: float = 0.0,
    big: bool = False,
    refusal: str = "",
    **options: Any,
) -> Variant:
    """Return a TIFF file of one page; the options are those of its writer."""

    def write(path: Path) -> None:
        content = tiff_writer.write([tiff_writer.page(image, **options)], order=options.get("order", "<"), big=big)
        path.write_bytes(content)

    return Variant("TIFF", name, ".tif", write, truth, refusal, tolerance)


def stored(content: bytes) -> Callable[[Path], object]:
    """Return a function that writes some bytes."""
    return lambda path: path.write_bytes(content)
