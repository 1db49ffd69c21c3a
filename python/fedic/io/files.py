"""Files that are regular, can be opened, and are not too large."""

import stat
from pathlib import Path

from fedic.errors import FedicError

__all__ = ["check_file", "read_bytes", "read_start"]


def check_file(path: Path, error: type[FedicError] = FedicError, what: str = "file", limit: int | None = None) -> None:
    """Check that a file can be read.

    Parameters
    ----------
    path : Path
        The file.
    error : type of FedicError
        What is raised.
    what : str
        Kind of the file in messages, such as ``"mesh file"``.
    limit : int, optional
        Largest size, in bytes.

    Raises
    ------
    FedicError
        Of the type `error`, if the file is missing, is a folder, a device or a pipe, is too large, or cannot be
        opened.
    """
    try:
        found = path.stat()
        if stat.S_ISDIR(found.st_mode):
            raise error(f"{path}: this is a folder; give the name of a file.")
        if not stat.S_ISREG(found.st_mode):
            raise error(f"{path}: this is a device or a pipe; save what it holds in a file.")
        if limit is not None and found.st_size > limit:
            raise error(f"{path}: the {what} has {found.st_size} bytes; one of this kind has at most {limit}.")
        path.open("rb").close()
    except FileNotFoundError:
        raise error(f"{path}: there is no such {what}; check the path.") from None
    except (OSError, ValueError) as fault:
        raise error(f"{path}: the {what} cannot be read ({getattr(fault, 'strerror', None) or fault}).") from fault


def read_start(path: Path, count: int, error: type[FedicError] = FedicError, what: str = "file") -> bytes:
    """Return the first bytes of a file; errors as for `check_file`.

    Parameters
    ----------
    path, error, what
        As for `check_file`.
    count : int
        Largest number of bytes.

    Returns
    -------
    bytes
        All of a file that is not larger.
    """
    check_file(path, error, what)
    return _read(path, count, error, what)


def read_bytes(path: Path, limit: int, error: type[FedicError] = FedicError, what: str = "file") -> bytes:
    """Return all bytes of a file.

    Parameters
    ----------
    path, error, what
        As for `check_file`.
    limit : int
        Largest size, in bytes.

    Returns
    -------
    bytes
        The content.

    Raises
    ------
    FedicError
        As for `check_file`.
    """
    check_file(path, error, what, limit)
    content = _read(path, limit + 1, error, what)
    if len(content) > limit:
        raise error(f"{path}: the {what} has more than {limit} bytes, the most for one of this kind.")
    return content


def _read(path: Path, count: int, error: type[FedicError], what: str) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(count)
    except OSError as fault:
        raise error(f"{path}: the {what} cannot be read ({fault.strerror or fault}).") from fault
