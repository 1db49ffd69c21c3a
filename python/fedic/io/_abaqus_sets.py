"""Node and element sets of an Abaqus input file."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic.errors import MeshError

__all__ = ["SetBlock", "merge_sets"]

Labels = NDArray[np.int64]


@dataclass
class SetBlock:
    """One ``*NSET`` or ``*ELSET`` block, or the set named on a ``*NODE`` or ``*ELEMENT`` line.

    Attributes
    ----------
    kind : str
        ``"node"`` or ``"element"``.
    name : str
        Name of the set; empty for nodes that belong to no set.
    instance : str
        Instance whose labels are meant, in a set of the assembly.
    generate : bool
        True if the items are triples: first, last, increment.
    of_elements : str
        Element set whose nodes make the node set.
    block : int or None
        Index of the element block that makes the set.
    lines : list of list of str
        Labels and names of other sets on each line.
    """

    kind: str
    name: str
    instance: str = ""
    generate: bool = False
    of_elements: str = ""
    block: int | None = None
    lines: list[list[str]] = field(default_factory=list)


def merge_sets(
    path: Path,
    set_blocks: Iterable[SetBlock],
    node_labels: Labels,
    element_labels: list[Labels],
    blocks: list[tuple[str, Labels]],
) -> tuple[dict[str, Labels], dict[str, list[Labels]]]:
    """Resolve the sets of one part to indices; blocks of one name are joined.

    Labels that the part does not define are ignored, as Abaqus does. Names are compared without case.

    Parameters
    ----------
    path : Path
        The file, for error messages.
    set_blocks : iterable of SetBlock
        The blocks in the order of the file.
    node_labels : ndarray of int, shape (n,)
        Labels of the nodes.
    element_labels : list of ndarray of int
        Labels of the elements of each block.
    blocks : list of (str, ndarray of int, shape (m, k))
        Connectivity of each block.

    Returns
    -------
    node_sets : dict of str to ndarray of int
        Node indices by name.
    cell_sets : dict of str to list of ndarray of int
        For each name and block the indices of the members in the block.

    Raises
    ------
    MeshError
        If a set refers to a set that does not exist or to itself.
    """
    named: dict[tuple[str, str], list[SetBlock]] = {}
    for block in set_blocks:
        if block.name:
            named.setdefault((block.kind, block.name.upper()), []).append(block)

    def members(kind: str, name: str, referring: tuple[str, ...]) -> Labels:
        key = (kind, name.upper())
        if name.upper() in referring:
            raise MeshError(f"{path}: the {kind} set {name} contains itself.")
        if key not in named:
            raise MeshError(
                f"{path}: the set {referring[-1]} contains {name!r}, which is neither a label nor a set of {kind}s."
            )
        parts = [labels_of(block, (*referring, name.upper())) for block in named[key]]
        return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *parts]))

    def labels_of(block: SetBlock, referring: tuple[str, ...]) -> Labels:
        if block.block is not None:
            return element_labels[block.block]
        if block.of_elements:
            rows = _rows(members("element", block.of_elements, referring), element_labels)
            nodes = [connectivity[at].ravel() for (_, connectivity), at in zip(blocks, rows, strict=True)]
            return node_labels[np.unique(np.concatenate(nodes))]
        if block.generate:
            try:
                ranges = [_range(*map(int, line)) for line in block.lines]
            except (TypeError, ValueError) as error:
                raise MeshError(
                    f"{path}: the set {block.name} has a line that is not first, last, increment."
                ) from error
            return np.concatenate([np.empty(0, dtype=np.int64), *ranges])
        items = [item for line in block.lines for item in line]
        numbers = [int(item) for item in items if item.isdigit()]
        sets = [members(block.kind, item, referring) for item in items if not item.isdigit()]
        return np.concatenate([np.array(numbers, dtype=np.int64), *sets])

    node_sets, cell_sets = {}, {}
    for (kind, _), same_name in named.items():
        name = same_name[0].name
        labels = members(kind, name, ("",))
        if kind == "node":
            node_sets[name] = _positions(labels, node_labels)
        else:
            cell_sets[name] = _rows(labels, element_labels)
    return node_sets, cell_sets


def _range(first: int, last: int, increment: int = 1) -> Labels:
    return np.arange(first, last + 1, increment, dtype=np.int64)


def _rows(labels: Labels, element_labels: list[Labels]) -> list[Labels]:
    return [_positions(labels, each) for each in element_labels]


def _positions(wanted: Labels, labels: Labels) -> Labels:
    return np.flatnonzero(np.isin(labels, wanted)).astype(np.int64)
