"""Named sets in formats without sets: fields ``set:NAME``, one for members and zero for others."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

__all__ = ["SET_PREFIX", "membership", "set_fields"]

SET_PREFIX = "set:"


def set_fields(sets: Mapping[str, NDArray[np.int64]], count: int) -> dict[str, NDArray[np.int64]]:
    """Return the fields that stand for sets.

    Parameters
    ----------
    sets : dict of str to ndarray of int
        Indices of the members of each set.
    count : int
        Number of nodes or cells of the mesh.

    Returns
    -------
    dict of str to ndarray of int64, shape (count,)
        A field for each set, by its name with the prefix.
    """
    return {SET_PREFIX + name: membership(members, count) for name, members in sets.items()}


def membership(members: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return ones for the members of a set and zeros for the others.

    Parameters
    ----------
    members : ndarray of int
        Indices of the members.
    count : int
        Number of nodes or cells of the mesh.

    Returns
    -------
    ndarray of int64, shape (count,)
        The field that stands for the set.
    """
    field = np.zeros(count, dtype=np.int64)
    field[members] = 1
    return field
