"""MATLAB's ``.mat`` files of versions 5 to 7: structs and arrays of numbers.

Own code, because SciPy's compiled reader ends the process on some damaged files.
"""

import math
import struct
import zlib
from typing import Any

import numpy as np

from fedic.cameras.files.syntax.tree import Tree

__all__ = ["LARGEST_ARRAY", "mat5_tree"]

LARGEST_ARRAY = 10_000
"""Largest array that is kept, in numbers; others hold the points of all views."""
_HEADING = 128
_MATRIX, _COMPRESSED = 14, 15
_STRUCT = 2
_NUMERIC = range(6, 16)
_DTYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""NumPy's type of each type of data."""
_LARGEST_ELEMENT = 2**26
_DEEPEST = 8


def mat5_tree(content: bytes) -> dict[str, Tree]:
    """Return the structs and numeric arrays of a file by name; all other kinds, such as objects, are left out.

    Parameters
    ----------
    content : bytes
        The file.

    Returns
    -------
    dict of str to Tree
        Arrays as MATLAB shows them, structs as dicts.

    Raises
    ------
    ValueError, struct.error, zlib.error
        If the file is not of these versions, or is damaged.
    """
    order = {b"IM": "<", b"MI": ">"}.get(content[126:128])
    if order is None:
        raise ValueError("no heading of version 5")
    tree: dict[str, Tree] = {}
    for kind, data in _elements(content[_HEADING:], order):
        if kind == _COMPRESSED:
            unpacking = zlib.decompressobj()
            data = unpacking.decompress(data, _LARGEST_ELEMENT)
            if unpacking.unconsumed_tail:
                raise ValueError("a variable is too large")
            kind, data = next(_elements(data, order), (0, b""))
        if kind == _MATRIX:
            name, value = _matrix(data, order, 0)
            if value is not None:
                tree[name] = value
    return tree


def _elements(data: bytes, order: str) -> Any:
    """Yield type and data of the elements, one after the other."""
    place = 0
    while place + 8 <= len(data):
        kind, size = struct.unpack_from(f"{order}II", data, place)
        if kind >> 16:  # a small element: both in four bytes, and the data in the next four
            kind, size, start, end = kind & 0xFFFF, kind >> 16, place + 4, place + 8
        else:
            start = place + 8
            end = start + size + (0 if kind == _COMPRESSED else -size % 8)
        if start + size > len(data):
            raise ValueError("a variable is longer than the file")
        yield kind, data[start : start + size]
        place = end


def _matrix(data: bytes, order: str, depth: int) -> tuple[str, Tree]:
    """Return name and value of a matrix; None for one that is no struct and has no numbers."""
    parts = _elements(data, order)
    flags, dimensions, name = (next(parts, (0, b""))[1] for _ in range(3))
    if len(flags) < 4 or len(dimensions) % 4 or not dimensions:
        return "", None
    (flag,) = struct.unpack_from(f"{order}I", flags)
    kind, is_complex = flag & 0xFF, bool(flag & 0x0800)
    shape = struct.unpack(f"{order}{len(dimensions) // 4}i", dimensions)
    named = name.decode("latin-1")
    if min(shape) < 0:
        raise ValueError("a size is negative")
    if kind == _STRUCT and math.prod(shape) == 1 and depth < _DEEPEST:
        return named, _struct(parts, order, depth)
    if kind not in _NUMERIC or is_complex or math.prod(shape) > LARGEST_ARRAY:
        return named, None
    stored, values = next(parts, (0, b""))
    if stored not in _DTYPES:
        return named, None
    array = np.frombuffer(values, dtype=order + _DTYPES[stored])
    return named, array.astype(np.float64).reshape(shape, order="F")


def _struct(parts: Any, order: str, depth: int) -> dict[str, Tree]:
    """Return the fields of a struct, whose names have a fixed length."""
    length = struct.unpack_from(f"{order}i", next(parts, (0, b""))[1])[0]
    names = next(parts, (0, b""))[1]
    if length < 1:
        raise ValueError("the names of a struct have no length")
    fields = [names[start : start + length].split(b"\0")[0].decode("latin-1") for start in range(0, len(names), length)]
    tree = {}
    for field, (kind, data) in zip(fields, parts, strict=False):
        value = _matrix(data, order, depth + 1)[1] if kind == _MATRIX and data else None
        if value is not None:
            tree[field] = value
    return tree
