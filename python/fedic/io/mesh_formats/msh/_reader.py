"""Reader of Gmsh's mesh files.

meshio 5.3 refuses version 4.0 as Gmsh 4.15 writes it, files of version 4.1 with entities outside all physical groups or
with partitions, and nodes with parameters in all versions.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic.io._mesh_file import Indices, MeshFile, unreadable
from fedic.io.mesh_formats._labelled_mesh import Numbering
from fedic.io.mesh_formats.msh._fields import read_set_fields
from fedic.io.mesh_formats.msh._numbers import Numbers
from fedic.io.mesh_formats.msh._sections import Sections
from fedic.io.mesh_formats.msh._tables import Elements, read_elements, read_elements_2, read_entities, read_nodes

__all__ = ["read_msh"]

_SAVE = "save it in Gmsh as version 4.1 or 2.2"
_START_OF_FILE = 1000
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
    if b"$NOD" in content[:_START_OF_FILE] and b"$MeshFormat" not in content[:_START_OF_FILE]:
        raise ValueError(f"it is of version 1 of Gmsh's format; {_SAVE}")
    sections = Sections(content)
    if "MeshFormat" not in sections:
        raise ValueError("it is no mesh file of Gmsh: the section $MeshFormat is missing")
    version, binary, order = _format(sections.one("MeshFormat"))

    def numbers(section: str) -> Numbers:
        return Numbers(sections.one(section), binary, order, f"${section}")

    if version == "2":
        tags, points = _nodes_2(sections, binary, order)
        count, rest = sections.counted("Elements")
        elements = read_elements_2(Numbers(rest, binary, order, "$Elements"), count, binary)
    else:
        of_entity: dict[tuple[int, int], list[int] | None] = {}
        if "PartitionedEntities" in sections:
            of_entity = read_entities(numbers("PartitionedEntities"), version, partitioned=True)
        elif "Entities" in sections:
            of_entity = read_entities(numbers("Entities"), version, partitioned=False)
        tags, points = read_nodes(numbers("Nodes"), version)
        elements = read_elements(numbers("Elements"), version, of_entity)
    blocks = _blocks(elements, tags, points)
    cell_sets, parts = _sets(elements, _names(sections))
    of_nodes, of_elements = read_set_fields(sections, binary, order)
    node_sets = {name: np.flatnonzero(np.isin(tags, members)) for name, members in of_nodes.items()}
    for name, members in of_elements.items():
        cell_sets[name] = [np.flatnonzero(np.isin(each.labels, members)) for each in elements]
    labels = [each.labels for each in elements]
    return MeshFile(points, blocks, node_sets, cell_sets, parts=parts, node_labels=tags, cell_labels=labels)


def _format(section: bytes) -> tuple[str, bool, str]:
    """Return the version, whether the file is binary, and its byte order."""
    first, _, rest = section.lstrip().partition(b"\n")
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


def _nodes_2(sections: Sections, binary: bool, order: str) -> tuple[Indices, NDArray[np.float64]]:
    if "ParametricNodes" not in sections:
        count, rest = sections.counted("Nodes")
        tags, points = Numbers(rest, binary, order, "$Nodes").records(count, ("int", 1), ("double", 3))
        return tags[:, 0], points
    count, rest = sections.counted("ParametricNodes")
    numbers = Numbers(rest, binary, order, "$ParametricNodes")
    all_tags, places = [], []
    for _ in range(count):
        tag, place, entity = numbers.records(1, ("int", 1), ("double", 3), ("int", 2))
        numbers.take("double", int(entity[0, 0]) % 3)  # one for a curve, two for a surface
        all_tags.append(tag[0])
        places.append(place[0])
    return np.array(all_tags, dtype=np.int64).reshape(-1), np.array(places, dtype=np.float64).reshape(-1, 3)


def _names(sections: Sections) -> dict[tuple[int, int], str]:
    """Return the names of the physical groups by dimension and number."""
    lines = [line for section in sections.all("PhysicalNames") for line in section.splitlines()[1:]]
    found = (_NAME.fullmatch(line) for line in lines)
    return {(int(m[1]), abs(int(m[2]))): m[3].decode("utf-8", "replace") for m in found if m is not None}


def _blocks(elements: list[Elements], tags: Indices, points: NDArray[np.float64]) -> list[tuple[str, Indices]]:
    """Return the elements with the nodes' places in the file instead of their tags."""
    numbering = Numbering(tags)
    order, ordered = numbering.order, numbering.sorted
    same = np.flatnonzero(ordered[1:] == ordered[:-1])
    moved = same[(points[order[same]] != points[order[same + 1]]).any(axis=1)]
    if len(moved):
        raise ValueError(f"it defines node {ordered[moved[0]]} twice, at two places")
    blocks = []
    for each in elements:
        nodes, known = numbering.places(each.tags)
        if not known.all():
            tag = each.tags[~known][0]
            raise ValueError(f"a {each.element.name} refers to node {tag}, which the file does not define")
        blocks.append((each.element.name, nodes[:, each.element.order] if each.element.order else nodes))
    return blocks


def _sets(
    elements: list[Elements], names: dict[tuple[int, int], str]
) -> tuple[dict[str, list[Indices]], dict[str, list[Indices]]]:
    """Return the physical groups with a name, and the numbered groups and surfaces."""
    none = np.empty(0, dtype=np.int64)
    # Gmsh writes names of groups without their elements too: all elements in version 2.2, for instance.
    named: dict[str, list[Indices]] = {name: [none] * len(elements) for name in names.values()}
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
            members = where.setdefault(name, [none] * len(elements))
            members[index] = np.union1d(members[index], rows)
    return named, parts
