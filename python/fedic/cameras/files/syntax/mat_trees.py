"""MATLAB's ``.mat`` files of any version as trees."""

import io
from pathlib import Path
from typing import Any

import numpy as np

from fedic.cameras.files.syntax.mat5 import LARGEST_ARRAY, mat5_tree
from fedic.cameras.files.syntax.tree import Tree
from fedic.errors import CameraError
from fedic.io.files import read_bytes

__all__ = ["read_mat"]

_LARGEST_FILE = 2**28
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_DEEPEST = 8


def read_mat(path: Path) -> dict[str, Tree]:
    """Read a file of versions 5 to 7.3.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    dict of str to Tree
        Structs and arrays by name, an array as MATLAB shows it; objects and all other kinds are left out.

    Raises
    ------
    CameraError
        If the file cannot be read.
    """
    content = read_bytes(path, _LARGEST_FILE, CameraError)
    try:
        return _hdf5(content) if _SIGNATURE in content[:1024] else mat5_tree(content)
    except Exception as error:  # h5py raises errors of many types for damaged files
        raise CameraError(
            f"{path}: this file cannot be read: truncated, or not a .mat file of version 5 or later "
            f"({str(error) or type(error).__name__})."
        ) from None


def _hdf5(content: bytes) -> dict[str, Tree]:
    import h5py

    with h5py.File(io.BytesIO(content), "r") as file:
        return _group(file, 0)


def _group(group: Any, depth: int) -> dict[str, Tree]:
    found = {name: _node(node, depth) for name, node in group.items() if not name.startswith("#")}
    return {name: value for name, value in found.items() if value is not None}


def _node(node: Any, depth: int) -> Tree:
    """Return an array, or a struct; None for any other kind."""
    import h5py

    if depth > _DEEPEST or "MATLAB_object_decode" in node.attrs:
        return None
    if isinstance(node, h5py.Group):
        return _group(node, depth + 1)
    if node.attrs.get("MATLAB_empty", 0) or node.dtype.kind not in "biuf" or node.size > LARGEST_ARRAY:
        return None
    return np.asarray(node[()]).T  # MATLAB stores by columns
