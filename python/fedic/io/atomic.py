"""Atomic writing of files: completely or not at all."""

import json
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fedic.errors import FedicError

__all__ = ["atomic_path", "make_folder", "write_json"]


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
        The temporary path, with the same suffix.

    Raises
    ------
    FedicError
        If the folder is missing or not writable; `path` is then unchanged.
    """
    temporary = path.with_name(f".{path.stem}-{uuid.uuid4().hex}{path.suffix}")
    try:
        yield temporary
        temporary.replace(path)
    except FileNotFoundError as error:
        raise FedicError(f"{path}: the folder {path.parent} does not exist; make it first.") from error
    except OSError as error:
        raise FedicError(f"{path}: the file cannot be written ({error.strerror}).") from error
    finally:
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
    except OSError as error:
        raise FedicError(f"{folder}: the folder cannot be created ({error.strerror}).") from error
    return folder
