"""Names of one page of a file of several: ``stack.tif#3``."""

import os
import re
from pathlib import Path

from fedic._internal.types import StrPath
from fedic.errors import ImageError

__all__ = ["image_stem", "split_page"]

_PAGE = re.compile(r"(?P<file>.+)#(?P<page>[0-9]{1,9})", re.DOTALL)


def split_page(path: StrPath) -> tuple[Path, int | None]:
    """Split the name of an image into its file and the number of the page.

    Parameters
    ----------
    path : str or path
        Such as ``"frame.tif"`` or ``"stack.tif#3"``. A file that has this very name is taken as it is.

    Returns
    -------
    file : Path
        The file.
    page : int or None
        Number of the page, from 0; None if the name has none.

    Raises
    ------
    ImageError
        If it is not a path.
    """
    try:
        whole = Path(path)
        match = _PAGE.fullmatch(os.fspath(whole))
        if match is None or whole.exists():
            return whole, None
    except (TypeError, ValueError, OSError) as error:
        raise ImageError(f"{path!r:.200}: this is not the name of an image file ({error}).") from error
    return Path(match["file"]), int(match["page"])


def image_stem(path: StrPath) -> str:
    """Return the stem of the files that hold the results of an image.

    Parameters
    ----------
    path : str or path
        Name of the image.

    Returns
    -------
    str
        ``"frame"`` for ``"frame.tif"``, ``"stack-3"`` for ``"stack.tif#3"``.

    Raises
    ------
    ImageError
        If it is not a path.
    """
    file, page = split_page(path)
    return file.stem if page is None else f"{file.stem}-{page}"
