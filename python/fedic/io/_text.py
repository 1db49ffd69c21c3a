"""Text of mesh files, whatever program and system wrote it."""

import codecs
from pathlib import Path

from fedic.errors import MeshError

__all__ = ["MAX_BYTES", "first_lines", "read_lines"]

MAX_BYTES = 4 << 30
"""Largest number of bytes that one mesh is read from, included files together."""
_HEAD = 1 << 18
_MARKS = {codecs.BOM_UTF8: "utf-8", codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}


def read_lines(path: Path, limit: int = MAX_BYTES) -> list[str]:
    r"""Return the lines of a text file.

    UTF-8 and UTF-16 are told by their byte order mark, or by their bytes; any other text is taken as Latin-1. Lines end
    with ``\n``, ``\r\n`` or ``\r``.

    Parameters
    ----------
    path : Path
        The file.
    limit : int
        Largest size in bytes.

    Returns
    -------
    list of str
        The lines without their ends.

    Raises
    ------
    MeshError
        If the file is missing, is no regular file, is larger than the limit or is not text.
    """
    data = _bytes(path, limit + 1)
    if len(data) > limit:
        raise MeshError(
            f"{path}: the mesh and the files it includes are larger than {MAX_BYTES >> 30} GiB; "
            "export only what is correlated."
        )
    text = _decoded(data)
    if "\0" in text:
        raise MeshError(f"{path}: this is a binary file, not text; export the mesh as text.")
    return _split(text)


def first_lines(path: Path) -> list[str]:
    """Return the lines at the beginning of a file, of which the last may be cut.

    Parameters
    ----------
    path : Path
        The file, text or not.

    Returns
    -------
    list of str
        The lines of the first 256 KiB, without their ends.

    Raises
    ------
    MeshError
        If the file is missing or is no regular file.
    """
    return _split(_decoded(_bytes(path, _HEAD)))


def _bytes(path: Path, count: int) -> bytes:
    try:
        if path.exists() and not path.is_file():
            raise MeshError(f"{path}: this is no regular file; give the name of a mesh file.")
        with path.open("rb") as file:
            return file.read(count)
    except (OSError, ValueError) as error:
        raise MeshError(f"{path}: the mesh file cannot be read ({getattr(error, 'strerror', error)}).") from error


def _split(text: str) -> list[str]:
    return text.rstrip("\x1a").replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _decoded(data: bytes) -> str:
    for mark, encoding in _MARKS.items():
        if data.startswith(mark):
            return data[len(mark) :].decode(encoding, errors="replace")
    if data[1:64:2] and not any(data[1:64:2]):
        return data.decode("utf-16-le", errors="replace")
    if data[0:64:2] and not any(data[0:64:2]):
        return data.decode("utf-16-be", errors="replace")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")
