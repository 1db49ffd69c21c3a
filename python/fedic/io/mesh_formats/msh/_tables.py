"""Nodes and elements of the versions of Gmsh's format."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fedic.io._mesh_file import Indices
from fedic.io.mesh_formats.msh._elements import ELEMENTS, Element
from fedic.io.mesh_formats.msh._numbers import Numbers

__all__ = ["Elements", "read_elements", "read_elements_2", "read_entities", "read_nodes"]


@dataclass
class Elements:
    """Elements of one type on one entity of the geometry, or of several in version 2.

    Attributes
    ----------
    element : Element
        Their type.
    labels : ndarray of int, shape (m,)
        Their own tags.
    tags : ndarray of int, shape (m, k)
        Tags of their nodes.
    entity : ndarray of int, shape (m,)
        Tag of the entity of each element.
    groups : list of ndarray of int
        Physical groups: each array gives one group for each element, 0 for none.
    """

    element: Element
    labels: Indices
    tags: Indices
    entity: Indices
    groups: list[Indices] = field(default_factory=list)


def read_entities(numbers: Numbers, version: str, partitioned: bool) -> dict[tuple[int, int], list[int] | None]:
    """Return the physical groups of each entity by dimension and tag; None for faces between partitions of a solid.

    Parameters
    ----------
    numbers : Numbers
        The section ``$Entities`` or ``$PartitionedEntities``.
    version : str
        ``"4.0"`` or ``"4.1"``.
    partitioned : bool
        Whether it is the second.

    Returns
    -------
    dict of (int, int) to list of int or None
        The groups.
    """
    of_entity: dict[tuple[int, int], list[int] | None] = {}
    if partitioned:
        numbers.one("size" if version == "4.1" else "int")
        ghosts = numbers.one("size" if version == "4.1" else "int")
        numbers.take("int", ghosts, 2)
    counts = numbers.take("size", 4)
    for dimension, count in enumerate(counts):
        for _ in range(count):
            tag = numbers.one("int")
            parent = dimension
            if partitioned:
                parent = int(numbers.take("int", 2)[0])
                numbers.take("int", numbers.one("size" if version == "4.1" else "int"))
            numbers.take("double", 3 if version == "4.1" and dimension == 0 else 6)
            groups = numbers.take("int", numbers.one("size"))
            inside = dimension == 2 and parent == 3
            of_entity[dimension, tag] = None if inside else [abs(int(group)) for group in groups]
            if dimension > 0:
                numbers.take("int", numbers.one("size"))
    return of_entity


def read_nodes(numbers: Numbers, version: str) -> tuple[Indices, NDArray[np.float64]]:
    """Return the tags and coordinates of the nodes in version 4.

    Parameters
    ----------
    numbers : Numbers
        The section ``$Nodes``.
    version : str
        ``"4.0"`` or ``"4.1"``.

    Returns
    -------
    tags : ndarray of int, shape (n,)
        Tags.
    points : ndarray, shape (n, 3)
        Coordinates.
    """
    num_blocks = numbers.one("size")
    numbers.take("size", 3 if version == "4.1" else 1)
    tags, points = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))]
    for _ in range(num_blocks):
        first, second, parametric = (int(number) for number in numbers.take("int", 3))
        dimension = first if version == "4.1" else second
        count = numbers.one("size")
        coordinates = 3 + (min(dimension, 3) if parametric else 0)
        if version == "4.1":
            tags.append(numbers.take("size", count))
            points.append(numbers.take("double", count, coordinates)[:, :3])
        else:
            labels, rows = numbers.records(count, ("int", 1), ("double", coordinates))
            tags.append(labels[:, 0])
            points.append(rows[:, :3])
    return np.concatenate(tags), np.concatenate(points)


def read_elements(numbers: Numbers, version: str, of_entity: dict[tuple[int, int], list[int] | None]) -> list[Elements]:
    """Return the elements in version 4.

    Parameters
    ----------
    numbers : Numbers
        The section ``$Elements``.
    version : str
        ``"4.0"`` or ``"4.1"``.
    of_entity : dict of (int, int) to list of int or None
        Physical groups of the entities.

    Returns
    -------
    list of Elements
        One for each block of the file, without faces between partitions of a solid.
    """
    num_blocks = numbers.one("size")
    numbers.take("size", 3 if version == "4.1" else 1)
    found = []
    for _ in range(num_blocks):
        first, second, code = (int(number) for number in numbers.take("int", 3))
        dimension, entity = (first, second) if version == "4.1" else (second, first)
        element = _element(code)
        count = numbers.one("size")
        rows = numbers.take("size" if version == "4.1" else "int", count, 1 + element.num_nodes)
        groups = of_entity.get((dimension, entity), [])
        if groups is not None:
            of_rows = [np.full(count, group) for group in groups]
            found.append(Elements(element, rows[:, 0], rows[:, 1:], np.full(count, entity), of_rows))
    return found


def read_elements_2(numbers: Numbers, count: int, binary: bool) -> list[Elements]:
    """Return the elements in version 2.

    Parameters
    ----------
    numbers : Numbers
        The section ``$Elements``, after the number of elements.
    count : int
        Number of elements.
    binary : bool
        Whether the file is binary.

    Returns
    -------
    list of Elements
        One for each type.
    """
    records = _binary_records(numbers, count) if binary else _text_records(numbers, count)
    rows: dict[int, list[Indices]] = {}
    for code, num_tags, table in records:
        tags = np.zeros((len(table), 3), dtype=np.int64)  # after the label come the physical group and the entity
        tags[:, : min(num_tags + 1, 3)] = table[:, : min(num_tags + 1, 3)]
        rows.setdefault(code, []).append(np.hstack([tags, table[:, 1 + num_tags :]]))
    found = []
    for code, tables in rows.items():
        table = np.concatenate(tables)
        found.append(Elements(_element(code), table[:, 0], table[:, 3:], table[:, 2], [np.abs(table[:, 1])]))
    return found


def _binary_records(numbers: Numbers, count: int) -> Iterator[tuple[int, int, Indices]]:
    """Yield the type, the number of tags, and the labels, tags and nodes of elements."""
    while count > 0:
        code, number, num_tags = (int(value) for value in numbers.take("int", 3))
        if number < 1 or num_tags < 0:
            raise ValueError("the section $Elements has a block without elements; the file is damaged")
        yield code, num_tags, numbers.take("int", number, 1 + num_tags + _element(code).num_nodes)
        count -= number


def _text_records(numbers: Numbers, count: int) -> Iterator[tuple[int, int, Indices]]:
    """Yield the type, the number of tags, and the labels, tags and nodes of elements."""
    values = numbers.rest()
    items = values.tolist()
    places: dict[tuple[int, int], list[int]] = {}
    place = 0
    for _ in range(count):
        if place + 3 > len(items):
            raise ValueError("the section $Elements ends before all its elements; the file is damaged")
        code, num_tags = items[place + 1], items[place + 2]
        if num_tags < 0:
            raise ValueError("an element has a negative number of tags; the file is damaged")
        places.setdefault((code, num_tags), []).append(place + 3)
        place += 3 + num_tags + _element(code).num_nodes
    if place > len(items):
        raise ValueError("the section $Elements ends before all its elements; the file is damaged")
    for (code, num_tags), starts in places.items():
        places_of_tags = np.add.outer(np.array(starts, dtype=np.int64), np.arange(num_tags + _element(code).num_nodes))
        labels = values[np.array(starts, dtype=np.int64) - 3]
        yield code, num_tags, np.column_stack([labels, values[places_of_tags]])


def _element(code: int) -> Element:
    if code not in ELEMENTS:
        raise ValueError(f"elements of Gmsh's type {code} are not read; save a mesh of first or second order")
    return ELEMENTS[code]
