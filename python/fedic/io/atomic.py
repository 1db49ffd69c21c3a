"""Writing a file whole or not at all."""

import json
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fedic.errors import FedicError

__all__ = ["make_folder", "replacing", "write_json"]


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path in the same folder, which takes the place of `path` once written.

    Parameters
    ----------
    path : Path
        The file to write.

    Yields
    ------
    Path
        Where to write, with the same suffix.

    Raises
    ------
    FedicError
        If the folder is missing or cannot be written to; `path` is then as it was.
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
    """Write a dictionary as indented JSON, whole or not at all.

    Parameters
    ----------
    path : Path
        The file to write.
    content : dict
        Of JSON types; NaN is refused.
    """
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def make_folder(folder: Path) -> Path:
    """Make a folder and its parents where missing.

    Parameters
    ----------
    folder : Path
        The folder.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    FedicError
        If it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FedicError(f"{folder}: the folder cannot be made ({error.strerror}).") from error
    return folder
