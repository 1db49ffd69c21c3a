"""Meshes in universal files of I-deas and Salome."""

from pathlib import Path

import numpy as np

from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats._labelled_mesh import LabelledMesh
from fedic.io.mesh_formats.unv.datasets import Dataset, read_datasets
from fedic.io.mesh_formats.unv.elements import BEAMS, element_of

__all__ = ["read_unv"]

_DOUBLE_NODES = {781, 2411}
_SINGLE_NODES = {15}
_ELEMENTS = {780: (1, 7), 2412: (1, 5)}
"""Places of the descriptor and of the number of nodes in an entry of the dataset."""
_GROUPS = {2435: 4, 2452: 4, 2467: 4, 2477: 4, 2429: 2, 2430: 2, 2432: 2}
"""How many numbers stand for each member of a group."""
_NODE, _ELEMENT = 7, 8
_SYSTEMS = 2420
_LARGEST = 2**53


def read_unv(path: Path) -> MeshFile:
    """Read the nodes, elements and groups of a universal file.

    Coordinates stay in the unit in which the file gives them.

    Parameters
    ----------
    path : Path
        The ``.unv`` file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file; groups of nodes and elements as sets.

    Raises
    ------
    MeshError
        If a line cannot be understood, a node is given in a coordinate system that is not the global one, or an element
        refers to a node that does not exist.
    """
    mesh = LabelledMesh()
    node_sets: dict[str, list[int]] = {}
    element_sets: dict[str, list[int]] = {}
    datasets = list(read_datasets(path))
    local = {number for each in datasets if each.number == _SYSTEMS for number in _local_systems(each)}
    for dataset in datasets:
        if dataset.number in _DOUBLE_NODES | _SINGLE_NODES:
            _add_nodes(dataset, mesh, local)
        elif dataset.number in _ELEMENTS:
            _add_elements(dataset, mesh)
        elif dataset.number in _GROUPS:
            _add_groups(dataset, node_sets, element_sets)
    arrays = [
        {name: np.array(labels, dtype=np.int64) for name, labels in sets.items()} for sets in (node_sets, element_sets)
    ]
    return mesh.contents(path, *arrays, keep_apart=False)


def _add_nodes(dataset: Dataset, mesh: LabelledMesh, local: set[int]) -> None:
    index = 0
    while index < len(dataset.lines):
        if dataset.number in _SINGLE_NODES:
            label, system, _, _, *point = dataset.reals(index)[:7]
            step = 1
        else:
            label, system, *_ = [*dataset.integers(index), 0, 0]
            point, step = dataset.reals(index + 1), 2
        if not 0 < label <= _LARGEST:
            raise dataset.error(index, f"{label:.15g} is not the number of a node.")
        if int(system) in local:
            raise dataset.error(
                index,
                f"node {int(label)} is given in the coordinate system {int(system)}, which is not the global one; "
                "export the mesh in global coordinates.",
            )
        if len(point) != 3:
            raise dataset.error(index + step - 1, f"node {int(label)} has {len(point)} coordinates, not 3.")
        mesh.nodes[int(label)] = (point[0], point[1], point[2])
        index += step


def _add_elements(dataset: Dataset, mesh: LabelledMesh) -> None:
    descriptor_at, count_at = _ELEMENTS[dataset.number]
    index = 0
    while index < len(dataset.lines):
        head, begin = dataset.integers(index), index
        if len(head) <= count_at:
            raise dataset.error(index, f"not a valid line of the dataset {dataset.number}: {len(head)} numbers.")
        label, descriptor, count = head[0], head[descriptor_at], head[count_at]
        index += 2 if descriptor in BEAMS else 1
        nodes: list[int] = []
        while len(nodes) < count:
            nodes += dataset.integers(index)
            index += 1
        if len(nodes) != count:
            raise dataset.error(begin, f"element {label} has {len(nodes)} nodes, not {count} as its first line says.")
        element = element_of(descriptor, nodes)
        if element is None:
            mesh.others.setdefault(f"type {descriptor} of {count} nodes")
        elif mesh.elements.setdefault(label, element) != element:
            raise dataset.error(
                begin, f"element {label} is defined a second time, in another way; remove one of the two."
            )


def _add_groups(dataset: Dataset, node_sets: dict[str, list[int]], element_sets: dict[str, list[int]]) -> None:
    size = _GROUPS[dataset.number]
    index = 0
    while index < len(dataset.lines):
        head = dataset.integers(index)
        count = head[-1] if head else 0
        name = dataset.lines[index + 1].strip() if index + 1 < len(dataset.lines) else ""
        name = name or f"group {head[0] if head else 0}"
        index += 2
        numbers: list[int] = []
        while len(numbers) < size * count:
            numbers += dataset.integers(index)
            index += 1
        if len(numbers) != size * count:
            raise dataset.error(index - 1, f"the group {name!r} has {len(numbers)} numbers for {count} members.")
        for kind, member in zip(numbers[0::size], numbers[1::size], strict=True):
            if kind in (_NODE, _ELEMENT):
                (node_sets if kind == _NODE else element_sets).setdefault(name, []).append(member)


def _local_systems(dataset: Dataset) -> set[int]:
    """Return the numbers of the coordinate systems that are not the global one."""
    found = set()
    # Two lines of the part, then for each system its number, its name and a matrix of four lines.
    for index in range(2, len(dataset.lines) - 5, 6):
        number, kind, *_ = [*dataset.integers(index), 0, 0]
        matrix = [dataset.reals(index + row) for row in (2, 3, 4, 5)]
        if kind != 0 or matrix != [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]:
            found.add(number)
    return found
