"""Trees of texts and numbers, the common form of YAML, XML and arrays."""

from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from fedic._internal.types import Floats
from fedic.errors import CameraError

__all__ = ["LARGEST_FILE", "Tree", "numbers", "text_of"]

LARGEST_FILE = 2**23
"""Largest camera file in bytes; OpenCV's files hold the points of all views too."""

Tree: TypeAlias = Any
"""A text, an array, a list of trees, or a dict from names to trees."""


def numbers(path: Path, key: str, tree: Tree, size: int | None = None) -> Floats:
    """Return the numbers of a tree as a flat array.

    Parameters
    ----------
    path : Path
        The file, for messages.
    key : str
        Name of the tree, for messages.
    tree : Tree
        Numbers, texts of numbers separated by spaces, lists of them, a matrix of OpenCV, or the ``data`` of a map.
    size : int, optional
        How many numbers there must be.

    Returns
    -------
    ndarray, shape (n,)
        The numbers, finite.

    Raises
    ------
    CameraError
        If the tree holds anything else.
    """
    tree = _data(path, key, tree)
    try:
        if isinstance(tree, np.ndarray):
            found = np.asarray(tree, dtype=np.float64).ravel()
        else:
            found = np.array([float(word) for word in _words(tree)], dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise CameraError(f"{path}: {key} does not hold numbers.") from None
    if size is not None and size > 1 and found.size == 1:
        raise CameraError(f"{path}: {key} is not a matrix or list of {size} numbers.")
    if size is not None and found.size != size:
        raise CameraError(f"{path}: {key} holds {found.size} numbers instead of {size}; is the file truncated?")
    if not np.isfinite(found).all():
        raise CameraError(f"{path}: {key} holds NaN or infinite numbers.")
    return found


def text_of(tree: Tree) -> str:
    """Return the text of a leaf; empty for anything else."""
    if isinstance(tree, np.ndarray) and tree.ndim == 0:
        tree = tree.item()
    return str(tree).strip() if isinstance(tree, str | int | float) else ""


def _data(path: Path, key: str, tree: Tree) -> Tree:
    """Return the entries of a matrix of OpenCV or ROS, whose sizes are checked; any other tree as it is."""
    if not isinstance(tree, dict):
        return tree
    if "data" not in tree:
        raise CameraError(f"{path}: {key} is not a matrix: it has no data, but {', '.join(tree) or 'nothing'}.")
    data = tree["data"]
    sizes = [tree[name] for name in ("rows", "cols") if name in tree] or tree.get("sizes", [])
    if len(sizes) > 0:
        try:
            channels = int("".join(filter(str.isdigit, text_of(tree.get("dt", "1")))) or 1)
            expected = int(np.prod([int(float(word)) for word in _words(sizes)], dtype=object)) * channels
            found = len(_words(data))
        except (TypeError, ValueError, OverflowError):
            raise CameraError(f"{path}: {key} is not a matrix: its sizes are not numbers.") from None
        if found != expected:
            raise CameraError(f"{path}: {key} holds {found} numbers, {expected} are announced; is the file truncated?")
    return data


def _words(tree: Tree) -> list[Any]:
    """Return the leaves of lists of lists; texts are split at spaces."""
    if isinstance(tree, str):
        return list(tree.split())
    if isinstance(tree, list | tuple):
        return [word for each in tree for word in _words(each)]
    if isinstance(tree, np.ndarray):
        return list(tree.ravel().tolist())
    if isinstance(tree, dict) or tree is None:
        raise TypeError
    return [tree]
