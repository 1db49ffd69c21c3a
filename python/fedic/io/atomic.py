"""Atomic writing of files: completely or not at all."""

import contextlib
import json
import re
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fedic.errors import FedicError

__all__ = ["atomic_path", "check_folder_writable", "make_folder", "remove_unfinished", "write_json"]

_UNFINISHED = re.compile(r"\.fedic-[0-9a-f]{32}(\.\w{1,8})?")
"""Names of temporary files; the name of the final file may be as long as the file system allows."""


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Provide a temporary path in the same folder, which replaces `path` when the block ends without error.

    Parameters
    ----------
    path : Path
        The file to write.

    Yields
    ------
    Path
        The temporary path, with the same suffix; hidden, and named ``.fedic-`` and 32 hexadecimal digits.

    Raises
    ------
    FedicError
        If the folder is missing or not writable, or the name is too long; `path` is then unchanged.
    """
    temporary = path.with_name(f".fedic-{uuid.uuid4().hex}{path.suffix}")
    try:
        yield temporary
        temporary.replace(path)
    except FileNotFoundError as error:
        if path.parent.is_dir():
            raise FedicError(f"{path}: the file vanished while it was written; another program removed it.") from error
        raise FedicError(f"{path}: the folder {path.parent} does not exist; make it first.") from error
    except OSError as error:
        raise FedicError(f"{path}: the file cannot be written ({_reason(error)}).") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write a dictionary as indented JSON, completely or not at all.

    Parameters
    ----------
    path : Path
        The file to write.
    content : dict
        Content of JSON types, without NaN.
    """
    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def make_folder(folder: Path) -> Path:
    """Create a folder and its parents if they are missing.

    Parameters
    ----------
    folder : Path
        The folder.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    FedicError
        If it cannot be created.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise FedicError(f"{folder}: there is something else of this name, not a folder; give another name.") from error
    except OSError as error:
        raise FedicError(f"{folder}: the folder cannot be created ({_reason(error)}).") from error
    return folder


def check_folder_writable(folder: Path) -> None:
    """Check, before any long work, that files can be made in a folder.

    Parameters
    ----------
    folder : Path
        An existing folder.

    Raises
    ------
    FedicError
        If no file can be made there.
    """
    probe = folder / f".fedic-{uuid.uuid4().hex}"
    try:
        probe.write_bytes(b"fedic")
    except OSError as error:
        raise FedicError(f"{folder}: no file can be written in this folder ({_reason(error)}).") from error
    finally:
        with contextlib.suppress(OSError):
            probe.unlink(missing_ok=True)


def remove_unfinished(folder: Path) -> None:
    """Remove the temporary files that a killed process left in a folder.

    Parameters
    ----------
    folder : Path
        The folder.

    Raises
    ------
    FedicError
        If one cannot be removed.
    """
    try:
        for path in folder.iterdir():
            if _UNFINISHED.fullmatch(path.name) and path.is_file() and not path.is_symlink():
                path.unlink(missing_ok=True)
    except OSError as error:
        raise FedicError(f"{folder}: an unfinished file cannot be removed ({_reason(error)}).") from error


def _reason(error: OSError) -> str:
    return error.strerror or str(error)
