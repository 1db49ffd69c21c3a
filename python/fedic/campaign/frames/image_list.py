"""The image files that names and patterns stand for, in the order of their numbers."""

import glob
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fedic.io.images import split_page

__all__ = ["expand_names", "natural_order"]


def expand_names(names: Sequence[str], folder: Path, reference: Path | None) -> tuple[list[str], list[str]]:
    """Expand patterns into the files that match, those of a pattern in natural order.

    Parameters
    ----------
    names : sequence of str
        File names and patterns, relative to `folder`.
    folder : Path
        The folder.
    reference : Path, optional
        The reference image, which patterns leave out.

    Returns
    -------
    list of str
        The files in order, each once: names as given, each pattern replaced by those of its matches that no name and no
        earlier pattern stands for.
    list of str
        Matches that were left out because they are the reference image.

    Raises
    ------
    ValueError
        If a file is named twice, or a pattern matches no other file than the reference image.
    """
    named = [name for name in names if not _is_pattern(name, folder)]
    seen: set[str] = set()
    for name in named:
        if _place(folder / name) in seen:
            raise ValueError(f"should name each file once: the results of {name!r} would overwrite each other")
        seen.add(_place(folder / name))
    files: list[str] = []
    left_out: list[str] = []
    for name in names:
        if not _is_pattern(name, folder):
            files.append(name)
            continue
        pattern, page = _split(name, folder)
        found = glob.glob(pattern, root_dir=folder)  # noqa: PTH207 - the pattern may be absolute
        matches = [f"{match}{page}" for match in sorted(found, key=natural_order)]
        same = {match for match in matches if reference is not None and _same_image(folder / match, reference)}
        rest = [match for match in matches if match not in same]
        if not rest:
            what = "another file than the reference image" if matches else "a file"
            raise ValueError(f"should match {what}: {name!r} matches none in {folder}")
        left_out += [match for match in matches if match in same]
        files += [match for match in rest if _place(folder / match) not in seen]
        seen.update(_place(folder / match) for match in rest)
    return files, left_out


def natural_order(name: str) -> tuple[Any, ...]:
    """Return a sorting key of a path: numbers in it count as numbers, so that ``frame_2`` comes before ``frame_10``.

    Parameters
    ----------
    name : str
        The path; its folders are compared before its last part.

    Returns
    -------
    tuple
        Key that compares with that of any other path.
    """
    parts = [re.split(r"(\d+)", part.casefold()) for part in Path(name).parts]
    return [[int(each) if index % 2 else each for index, each in enumerate(part)] for part in parts], name


def _is_pattern(name: str, folder: Path) -> bool:
    return glob.has_magic(name) and not os.path.lexists(folder / _split(name, folder)[0])


def _split(name: str, folder: Path) -> tuple[str, str]:
    """Split a name or pattern into that of the files and the page with its sign, which may be empty."""
    if split_page(folder / name)[1] is None:
        return name, ""
    file, sign, page = name.rpartition("#")
    return file, sign + page


def _place(path: Path) -> str:
    return os.path.normpath(path)


def _same_image(path: Path, other: Path) -> bool:
    (file, page), (other_file, other_page) = split_page(path), split_page(other)
    try:
        return (page or 0) == (other_page or 0) and file.samefile(other_file)
    except OSError:
        return False
