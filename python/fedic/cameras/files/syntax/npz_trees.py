"""Arrays of ``.npz`` files, whose sizes are checked before they are read."""

import io
import math
import zipfile
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

from fedic.cameras.files.syntax.tree import Tree
from fedic.errors import CameraError
from fedic.io.files import read_bytes

__all__ = ["read_npz"]

_LARGEST_ARRAY = 2**16
"""Largest array that is read, in bytes; others, such as the points of all views, are left out."""
_LARGEST_ARCHIVE = 2**28
_MOST_MEMBERS = 10_000


def read_npz(path: Path) -> dict[str, Tree]:
    """Read the small arrays of numbers and texts of a file.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    dict of str to Tree
        An array, or a text, by its name. Python objects are not loaded.

    Raises
    ------
    CameraError
        If the file cannot be read.
    """
    content = read_bytes(path, _LARGEST_ARCHIVE, CameraError)
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            if len(members) > _MOST_MEMBERS:
                raise ValueError(f"{len(members)} members")
            return {
                member.filename.removesuffix(".npy"): _array(archive.read(member))
                for member in members
                if member.file_size <= _LARGEST_ARRAY
            }
    except Exception as error:  # zipfile, zlib and NumPy raise errors of a dozen types for damaged files
        raise CameraError(
            f"{path}: NumPy cannot read this file: truncated, or of another format "
            f"({str(error) or type(error).__name__})."
        ) from None


def _array(content: bytes) -> Tree:
    """Return an array of numbers or texts; None for any other."""
    file = io.BytesIO(content)
    version = npy.read_magic(file)
    header = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}.get(version)
    if header is None:
        return None
    shape, by_columns, dtype = header(file)
    data = content[file.tell() :]
    if dtype.hasobject or dtype.kind not in "biufU":
        return None
    if math.prod(shape) * dtype.itemsize != len(data) or dtype.itemsize == 0:
        raise ValueError("the data do not have the size that the heading announces")
    array = np.frombuffer(data, dtype=dtype).reshape(shape, order="F" if by_columns else "C")
    return str(array) if dtype.kind == "U" and array.ndim == 0 else array
