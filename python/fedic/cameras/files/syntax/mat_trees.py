"""MATLAB's ``.mat`` files as trees: structs and arrays of numbers, no objects."""

import io
from pathlib import Path
from typing import Any

import numpy as np

from fedic.cameras.files.syntax.tree import Tree
from fedic.errors import CameraError
from fedic.io.text import read_bytes

__all__ = ["read_mat"]

_LARGEST_FILE = 2**28
_LARGEST_ARRAY = 10_000
"""Largest array that is kept, in numbers; others hold the points of all views."""
_DEEPEST = 8


def read_mat(path: Path) -> dict[str, Tree]:
    """Read a file of any version: 5 to 7 with SciPy, 7.3 with h5py.

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
        If the file cannot be read, or the package that reads it is not installed.
    """
    content = read_bytes(path, _LARGEST_FILE, CameraError)
    is_hdf5 = b"\x89HDF\r\n\x1a\n" in content[:1024]
    try:
        return _hdf5(content) if is_hdf5 else _version_5(content)
    except ModuleNotFoundError as error:
        package, extra = ("h5py", "hdf5") if is_hdf5 else ("SciPy", "matlab")
        raise CameraError(
            f"{path}: {package} reads this .mat file and is not installed: pip install 'fedic[{extra}]'."
        ) from error
    except Exception as error:  # both packages raise errors of many types for damaged files
        raise CameraError(
            f"{path}: this file cannot be read: truncated, or not a .mat file ({error or type(error).__name__})."
        ) from None


def _version_5(content: bytes) -> dict[str, Tree]:
    from scipy.io import loadmat

    found = loadmat(io.BytesIO(content), struct_as_record=True, squeeze_me=False, chars_as_strings=True)
    return _named({name: _of_scipy(value, 0) for name, value in found.items() if not name.startswith("__")})


def _of_scipy(value: Any, depth: int) -> Tree:
    if not isinstance(value, np.ndarray) or depth > _DEEPEST or type(value).__name__ == "MatlabFunction":
        return None
    if value.dtype.names is not None and value.dtype.kind == "V" and type(value).__name__ != "MatlabOpaque":
        if value.size != 1:
            return None
        entry = value.ravel()[0]
        return _named({name: _of_scipy(entry[name], depth + 1) for name in value.dtype.names})
    return value if value.dtype.kind in "biuf" and value.size <= _LARGEST_ARRAY else None


def _hdf5(content: bytes) -> dict[str, Tree]:
    import h5py

    with h5py.File(io.BytesIO(content), "r") as file:
        return _named({name: _of_hdf5(node, 0) for name, node in file.items() if not name.startswith("#")})


def _of_hdf5(node: Any, depth: int) -> Tree:
    import h5py

    if depth > _DEEPEST or "MATLAB_object_decode" in node.attrs:
        return None
    if isinstance(node, h5py.Group):
        return _named({name: _of_hdf5(child, depth + 1) for name, child in node.items()})
    if node.attrs.get("MATLAB_empty", 0) or node.dtype.kind not in "biuf" or node.size > _LARGEST_ARRAY:
        return None
    return np.asarray(node[()]).T  # MATLAB stores by columns


def _named(tree: dict[str, Tree]) -> dict[str, Tree]:
    return {name: value for name, value in tree.items() if value is not None}
