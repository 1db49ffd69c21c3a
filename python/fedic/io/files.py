"""Files that are regular, can be opened, and are not too large."""

import stat
from pathlib import Path

from fedic.errors import FedicError

__all__ = ["file_size", "read_bytes", "read_start"]


def file_size(path: Path, error: type[FedicError] = FedicError, what: str = "file") -> int:
    """Return the size of a file, after a check that it can be read.

    Parameters
    ----------
    path : Path
        The file.
    error : type of FedicError
        What is raised.
    what : str
        Kind of the file in messages, such as ``"mesh file"``.

    Returns
    -------
    int
        The size in bytes.

    Raises
    ------
    FedicError
        Of the type `error`, if the file is missing, is a folder, a device or a pipe, or cannot be opened.
    """
    try:
        found = path.stat()
        if stat.S_ISDIR(found.st_mode):
            raise error(f"{path}: this is a folder; give the name of a file.")
        if not stat.S_ISREG(found.st_mode):
            raise error(f"{path}: this is a device or a pipe; save what it holds in a file.")
        path.open("rb").close()
    except FileNotFoundError:
        raise error(f"{path}: there is no such {what}; check the path.") from None
    except (OSError, ValueError) as fault:
        raise error(f"{path}: the {what} cannot be read ({getattr(fault, 'strerror', None) or fault}).") from fault
    return found.st_size


def read_start(path: Path, count: int, error: type[FedicError] = FedicError, what: str = "file") -> bytes:
    """Return the first bytes of a file; parameters and errors as for `file_size`.

    Parameters
    ----------
    path, error, what
        As for `file_size`.
    count : int
        Largest number of bytes.

    Returns
    -------
    bytes
        All of a file that is not larger.
    """
    file_size(path, error, what)
    try:
        with path.open("rb") as file:
            return file.read(count)
    except OSError as fault:
        raise error(f"{path}: the {what} cannot be read ({fault.strerror or fault}).") from fault


def read_bytes(path: Path, limit: int, error: type[FedicError] = FedicError, what: str = "file") -> bytes:
    """Return all bytes of a file.

    Parameters
    ----------
    path, error, what
        As for `file_size`.
    limit : int
        Largest size, in bytes.

    Returns
    -------
    bytes
        The content.

    Raises
    ------
    FedicError
        As by `file_size`, and if the file is larger than the limit.
    """
    size = file_size(path, error, what)
    if size > limit:
        raise error(f"{path}: the file has {size} bytes; one of this kind has at most {limit}.")
    content = read_start(path, limit + 1, error, what)
    if len(content) > limit:
        raise error(f"{path}: the file has more than {limit} bytes, the most for one of this kind.")
    return content
