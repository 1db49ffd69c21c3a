"""Reader of Gmsh's mesh files.

meshio's reader refuses version 4.0, and files of version 4.1 that hold entities without a physical group, partitions or
parameters of the nodes; of an entity that is in several physical groups it keeps one.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic.io._mesh_file import Indices, MeshFile, unreadable
from fedic.io.msh._fields import read_set_fields
from fedic.io.msh._numbers import Numbers
from fedic.io.msh._tables import Elements, read_elements, read_elements_2, read_entities, read_nodes

__all__ = ["read_msh"]

_SAVE = "save it in Gmsh as version 4.1 or 2.2"
_NAME = re.compile(rb'\s*(\d+)\s+(-?\d+)\s+"(.*)"\s*')


def read_msh(path: Path) -> MeshFile:
    """Read a mesh file of Gmsh, text or binary.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file. The sets are the physical groups that have a name; the physical groups of
        surfaces can be chosen by number too, and the surfaces of the geometry as ``surface NUMBER``. Fields
        ``set:NAME`` are sets.

    Raises
    ------
    MeshError
        If the file is damaged, or is of another program or version.
    """
    try:
        return _read(path.read_bytes())
    except (ValueError, OSError) as error:
        raise unreadable(path, str(error)) from error


def _read(content: bytes) -> MeshFile:
    version, binary, order = _format(content)

    def numbers(section: str) -> Numbers:
        return Numbers(_section(content, section) or b"", binary, order, f"${section}")

    if version == "2":
        tags, points = _nodes_2(content, binary, order)
        count, rest = _counted(content, "Elements")
        elements = read_elements_2(Numbers(rest, binary, order, "$Elements"), count, binary)
    else:
        partitioned = _section(content, "PartitionedEntities") is not None
        of_entity = {}
        if partitioned:
            of_entity = read_entities(numbers("PartitionedEntities"), version, partitioned=True)
        elif _section(content, "Entities") is not None:
            of_entity = read_entities(numbers("Entities"), version, partitioned=False)
        tags, points = read_nodes(numbers("Nodes"), version)
        elements = read_elements(numbers("Elements"), version, of_entity)
    blocks = _blocks(elements, tags, points)
    cell_sets, parts = _sets(elements, _names(content))
    of_nodes, of_elements = read_set_fields(content, binary, order)
    node_sets = {name: np.flatnonzero(np.isin(tags, members)) for name, members in of_nodes.items()}
    for name, members in of_elements.items():
        cell_sets[name] = [np.flatnonzero(np.isin(each.labels, members)) for each in elements]
    return MeshFile(points, blocks, node_sets, cell_sets, parts=parts)


def _format(content: bytes) -> tuple[str, bool, str]:
    """Return the version, whether the file is binary, and its byte order."""
    if b"$NOD" in content[:1000]:
        raise ValueError(f"it is of version 1 of Gmsh's format; {_SAVE}")
    body = _section(content, "MeshFormat")
    if body is None:
        raise ValueError("it is no mesh file of Gmsh: the section $MeshFormat is missing")
    first, _, rest = body.lstrip().partition(b"\n")
    fields = first.split()
    version = fields[0].decode("ascii", "replace") if fields else ""
    known = {"2": "2", "2.0": "2", "2.1": "2", "2.2": "2", "4": "4.0", "4.0": "4.0", "4.1": "4.1"}
    if len(fields) != 3 or version not in known:
        raise ValueError(f"version {version!r} of Gmsh's format is not read; {_SAVE}")
    if fields[1] == b"0":
        return known[version], False, "<"
    if fields[2] != b"8":
        raise ValueError(f"its numbers have {fields[2].decode('ascii', 'replace')} bytes, not 8; {_SAVE}")
    return known[version], True, "<" if rest[:4] == b"\x01\x00\x00\x00" else ">"


def _section(content: bytes, name: str) -> bytes | None:
    """Return what stands between ``$NAME`` and ``$EndNAME``; None if there is no such section."""
    start = re.search(rb"(?m)^\$" + name.encode() + rb"[ \t]*\r?\n", content)
    if start is None:
        return None
    end = content.find(b"$End" + name.encode(), start.end())
    if end < 0:
        raise ValueError(f"the section ${name} has no end; the file is damaged")
    return content[start.end() : end]


def _counted(content: bytes, name: str) -> tuple[int, bytes]:
    """Return the number in the first line of a section of version 2, and the rest."""
    section = _section(content, name)
    if section is None:
        raise ValueError(f"the section ${name} is missing")
    first, _, rest = section.partition(b"\n")
    try:
        return int(first), rest
    except ValueError as error:
        raise ValueError(f"the section ${name} does not begin with a number; the file is damaged") from error


def _nodes_2(content: bytes, binary: bool, order: str) -> tuple[Indices, NDArray[np.float64]]:
    if _section(content, "ParametricNodes") is None:
        count, rest = _counted(content, "Nodes")
        tags, points = Numbers(rest, binary, order, "$Nodes").records(count, ("int", 1), ("double", 3))
        return tags[:, 0], points
    count, rest = _counted(content, "ParametricNodes")
    numbers = Numbers(rest, binary, order, "$ParametricNodes")
    all_tags, places = [], []
    for _ in range(count):
        tag, place, entity = numbers.records(1, ("int", 1), ("double", 3), ("int", 2))
        numbers.take("double", int(entity[0, 0]) % 3)  # one for a curve, two for a surface
        all_tags.append(tag[0])
        places.append(place[0])
    return np.array(all_tags, dtype=np.int64).reshape(-1), np.array(places, dtype=np.float64).reshape(-1, 3)


def _names(content: bytes) -> dict[tuple[int, int], str]:
    """Return the names of the physical groups by dimension and number."""
    lines = (_section(content, "PhysicalNames") or b"").splitlines()[1:]
    found = (_NAME.fullmatch(line) for line in lines)
    return {(int(m[1]), abs(int(m[2]))): m[3].decode("utf-8", "replace") for m in found if m is not None}


def _blocks(elements: list[Elements], tags: Indices, points: NDArray[np.float64]) -> list[tuple[str, Indices]]:
    """Return the elements with the nodes' places in the file instead of their tags."""
    order = np.argsort(tags, kind="stable")
    ordered = tags[order]
    same = np.flatnonzero(ordered[1:] == ordered[:-1])
    moved = same[(points[order[same]] != points[order[same + 1]]).any(axis=1)]
    if len(moved):
        raise ValueError(f"it defines node {ordered[moved[0]]} twice, at two places")
    blocks = []
    for each in elements:
        place = np.minimum(np.searchsorted(ordered, each.tags), len(tags) - 1)
        unknown = ordered[place] != each.tags if len(tags) else np.ones_like(each.tags, dtype=bool)
        if unknown.any():
            tag = each.tags[unknown][0]
            raise ValueError(f"a {each.element.name} refers to node {tag}, which the file does not define")
        nodes = order[place]
        blocks.append((each.element.name, nodes[:, each.element.order] if each.element.order else nodes))
    return blocks


def _sets(
    elements: list[Elements], names: dict[tuple[int, int], str]
) -> tuple[dict[str, list[Indices]], dict[str, list[Indices]]]:
    """Return the physical groups with a name, and the numbered groups and surfaces."""
    named: dict[str, list[Indices]] = {}
    parts: dict[str, list[Indices]] = {}
    for index, each in enumerate(elements):
        dimension = each.element.dimension
        found = []
        for groups in each.groups:
            for group in np.unique(groups[groups != 0]):
                rows = np.flatnonzero(groups == group)
                found += [(named, names[dimension, group], rows)] if (dimension, group) in names else []
                found += [(parts, str(group), rows)] if dimension == 2 else []
        if dimension == 2:
            found += [(parts, f"surface {tag}", np.flatnonzero(each.entity == tag)) for tag in np.unique(each.entity)]
        for where, name, rows in found:
            members = where.setdefault(name, [np.empty(0, dtype=np.int64)] * len(elements))
            members[index] = np.union1d(members[index], rows)
    return named, parts
