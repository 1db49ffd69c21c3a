"""Text of files of any program: byte order marks, encodings, a limit of the size."""

import codecs
import stat
from pathlib import Path

from fedic.errors import FedicError

__all__ = ["read_bytes", "read_text"]

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""Byte order marks; that of UTF-32 begins with that of UTF-16."""


def read_text(path: Path, limit: int, error: type[FedicError] = FedicError) -> str:
    """Read a text file.

    The encoding is that of the byte order mark, which is left out; without one it is UTF-8, UTF-16 if every second byte
    is zero, or else Latin-1, in which every byte is a character.

    Parameters
    ----------
    path : Path
        The file.
    limit : int
        Largest size, in bytes.
    error : type of FedicError
        What is raised.

    Returns
    -------
    str
        The text.

    Raises
    ------
    FedicError
        Of the type `error`, if the file is missing, not a regular file, too large, cannot be read, or is not text.
    """
    content = read_bytes(path, limit, error)
    try:
        text = _decoded(content)
    except UnicodeDecodeError as fault:
        raise error(f"{path}: the file cannot be read as text: it is not {fault.encoding} ({fault.reason}).") from None
    if "\0" in text:
        raise error(f"{path}: the file cannot be read as text: it holds zero bytes.")
    return text


def read_bytes(path: Path, limit: int, error: type[FedicError] = FedicError) -> bytes:
    """Read a file; parameters and errors as for `read_text`."""
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):
            raise error(f"{path}: this is a folder or a device, not a file.")
        if found.st_size > limit:
            raise error(f"{path}: the file has {found.st_size} bytes; one of this kind has at most {limit}.")
        with path.open("rb") as file:
            content = file.read(limit + 1)
    except FileNotFoundError:
        raise error(f"{path}: there is no such file; check the path.") from None
    except (OSError, ValueError) as fault:
        raise error(f"{path}: the file cannot be read ({getattr(fault, 'strerror', None) or fault}).") from fault
    if len(content) > limit:
        raise error(f"{path}: the file has more than {limit} bytes, the most for one of this kind.")
    return content


def _decoded(content: bytes) -> str:
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            return content[len(mark) :].decode(encoding)
    zeros = content[:1024].count(0)
    if zeros and zeros >= 0.4 * len(content[:1024]):
        return content.decode("utf-16-le" if content[1:2] == b"\0" else "utf-16-be")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1")
