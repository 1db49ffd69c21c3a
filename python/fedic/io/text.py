"""Text of files of any program: byte order marks and encodings."""

import codecs
from pathlib import Path

from fedic.errors import FedicError
from fedic.io.files import read_bytes

__all__ = ["decoded", "read_text"]

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""Byte order marks; that of UTF-32 begins with that of UTF-16."""
_HEAD = 1024


def read_text(path: Path, limit: int, error: type[FedicError] = FedicError, what: str = "file") -> str:
    """Read a text file.

    Parameters
    ----------
    path : Path
        The file.
    limit : int
        Largest size, in bytes.
    error : type of FedicError
        What is raised.
    what : str
        Kind of the file in messages, such as ``"camera file"``.

    Returns
    -------
    str
        The text, as by `decoded`.

    Raises
    ------
    FedicError
        Of the type `error`, if the file is missing, not a regular file, too large, cannot be read, or is not text.
    """
    content = read_bytes(path, limit, error, what)
    try:
        text = decoded(content)
    except UnicodeDecodeError as fault:
        raise error(f"{path}: the file cannot be read as text: it is not {fault.encoding} ({fault.reason}).") from None
    if "\0" in text:
        raise error(f"{path}: the file cannot be read as text: it holds zero bytes.")
    return text


def decoded(content: bytes, faults: str = "strict") -> str:
    """Decode text.

    The encoding is that of the byte order mark, which is left out; without one it is UTF-8, UTF-16 if most bytes in odd
    or in even places are zero and no others, or else Latin-1, in which every byte is a character.

    Parameters
    ----------
    content : bytes
        The text.
    faults : str
        What is done where UTF-16, or what the byte order mark says, is violated: ``"strict"`` or ``"replace"``.

    Returns
    -------
    str
        The text; it has zeros if it is none.

    Raises
    ------
    UnicodeDecodeError
        If the content violates its encoding.
    """
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            return content[len(mark) :].decode(encoding, faults)
    even, odd = (content[start:_HEAD:2].count(0) for start in (0, 1))
    if max(even, odd) > min(len(content), _HEAD) / 4 and not min(even, odd):
        return content.decode("utf-16-be" if even else "utf-16-le", faults)
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1")
