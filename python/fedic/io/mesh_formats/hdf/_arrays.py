"""Arrays of HDF5 files."""

from typing import Any

__all__ = ["MAX_NUMBERS", "group", "numbers"]

MAX_NUMBERS = 2**29
"""Longest array that is read."""


def group(parent: Any, name: str) -> Any:
    """Return a group or array of a group.

    Parameters
    ----------
    parent : h5py group
        The group.
    name : str
        Name, or names with slashes between them.

    Returns
    -------
    h5py group or dataset
        What has the name.

    Raises
    ------
    ValueError
        If there is none, or it lies in another file.
    """
    import h5py

    for part in filter(None, name.split("/")):
        link = parent.get(part, getlink=True) if isinstance(parent, h5py.Group) else None
        if isinstance(link, h5py.ExternalLink):
            raise ValueError(f"{part!r} is a link to another file, which is not followed")
        try:
            parent = parent[part]
        except (KeyError, ValueError) as error:
            raise ValueError(f"it holds no {name!r}") from error
    return parent


def numbers(parent: Any, name: str) -> Any:
    """Return the numbers of an array.

    Parameters
    ----------
    parent : h5py group
        The group.
    name : str
        Name of the array.

    Returns
    -------
    ndarray
        The numbers.

    Raises
    ------
    ValueError
        If there is none, it holds no numbers, its data lie in other files, or it is too large.
    """
    import h5py

    array = group(parent, name)
    if not isinstance(array, h5py.Dataset) or array.dtype.base.kind not in "iuf":
        raise ValueError(f"{name!r} is no array of numbers")
    if array.is_virtual or array.external:
        raise ValueError(f"the numbers of {name!r} lie in another file, which is not read")
    if array.size > MAX_NUMBERS:
        raise ValueError(f"{name!r} has {array.size} numbers, more than the {MAX_NUMBERS} that are read")
    return array[()]
