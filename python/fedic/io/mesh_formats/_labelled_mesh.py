"""Nodes and elements by the numbers that a finite element program gives them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES
from fedic.errors import MeshError
from fedic.io._mesh_file import MeshFile

__all__ = ["Element", "LabelledMesh", "Labels", "Numbering"]

Labels = NDArray[np.int64]
_NONE = np.empty(0, dtype=np.int64)


class Element(NamedTuple):
    """One element: its cell type, the numbers of its nodes, and whether it stays apart from the mesh as a whole."""

    cell: str
    nodes: tuple[int, ...]
    apart: bool = False


class Numbering:
    """The places of numbers in a list.

    Parameters
    ----------
    labels : ndarray of int, shape (n,)
        The numbers; the place of one that is there several times is its first.
    """

    def __init__(self, labels: Labels) -> None:
        self.order = np.argsort(labels, kind="stable")
        self.sorted = labels[self.order]

    def places(self, wanted: Labels) -> tuple[Labels, NDArray[np.bool_]]:
        """Return the places of numbers, and which of them are in the list at all.

        Parameters
        ----------
        wanted : ndarray of int
            Any numbers.

        Returns
        -------
        places : ndarray of int
            Of the shape of `wanted`; meaningless where a number is not in the list.
        known : ndarray of bool
            Of the shape of `wanted`.
        """
        if not len(self.sorted):
            return np.zeros_like(wanted), np.zeros(wanted.shape, dtype=bool)
        at = np.minimum(np.searchsorted(self.sorted, wanted), len(self.sorted) - 1)
        return self.order[at], self.sorted[at] == wanted

    def present(self, wanted: Labels) -> Labels:
        """Return the places of those numbers that are in the list, in ascending order, each once.

        Parameters
        ----------
        wanted : ndarray of int
            Any numbers.

        Returns
        -------
        ndarray of int
            Their places.
        """
        places, known = self.places(wanted)
        return np.unique(places[known])


@dataclass
class LabelledMesh:
    """Nodes and elements in the order in which their numbers first appear.

    Attributes
    ----------
    nodes : dict of int to tuple of float
        Coordinates of each node.
    elements : dict of int to Element
        Elements of known types.
    others : dict of str to None
        Names of the element types that fedic does not use, in order.
    """

    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    elements: dict[int, Element] = field(default_factory=dict)
    others: dict[str, None] = field(default_factory=dict)

    def node_labels(self) -> Labels:
        """Return the numbers of the nodes in order."""
        return np.fromiter(self.nodes, dtype=np.int64, count=len(self.nodes))

    def with_more(self, more: "LabelledMesh") -> "LabelledMesh":
        """Return this mesh with the nodes and elements of another, which replace those of the same number.

        Parameters
        ----------
        more : LabelledMesh
            The other mesh.

        Returns
        -------
        LabelledMesh
            This mesh itself if the other is empty.
        """
        if not more.nodes and not more.elements and not more.others:
            return self
        return LabelledMesh(self.nodes | more.nodes, self.elements | more.elements, self.others | more.others)

    def has_surface(self) -> bool:
        """Return whether surface elements belong to the mesh as a whole."""
        return any(element.cell in CELL_TYPES and not element.apart for element in self.elements.values())

    def is_attached(self) -> bool:
        """Return whether surface elements that stay apart share a node with surface elements that do not."""
        nodes: dict[bool, set[int]] = {False: set(), True: set()}
        for element in self.elements.values():
            if element.cell in CELL_TYPES:
                nodes[element.apart].update(element.nodes)
        return not nodes[True].isdisjoint(nodes[False])

    def contents(
        self, path: Path, node_sets: Mapping[str, Labels], element_sets: Mapping[str, Labels], *, keep_apart: bool
    ) -> MeshFile:
        """Return the contents by index.

        Parameters
        ----------
        path : Path
            The file, for error messages.
        node_sets, element_sets : dict of str to ndarray of int
            Numbers of the members of each set; numbers that the mesh does not have are ignored.
        keep_apart : bool
            True if elements that stay apart become `MeshFile.surfaces`, one for each set of them; false if they are
            cells of the mesh as all others.

        Returns
        -------
        MeshFile
            One block for each cell type.

        Raises
        ------
        MeshError
            If an element refers to a node that does not exist.
        """
        nodes = Numbering(self.node_labels())
        points = np.array(list(self.nodes.values()), dtype=np.float64).reshape(-1, 3)
        groups: dict[tuple[str, bool], list[int]] = {}
        for label, element in self.elements.items():
            groups.setdefault((element.cell, element.apart and keep_apart), []).append(label)
        of_blocks: list[Labels] = []
        contents = MeshFile(points, [], node_labels=self.node_labels(), cell_labels=of_blocks)
        contents.node_sets = {name: nodes.present(labels) for name, labels in node_sets.items()}
        contents.cell_sets = {name: [] for name in element_sets}
        for (cell, apart), labels in groups.items():
            cells = self._connectivity(path, labels, nodes)
            numbering = Numbering(np.array(labels, dtype=np.int64))
            members = {name: numbering.present(wanted) for name, wanted in element_sets.items()}
            if not apart:
                contents.blocks.append((cell, cells))
                of_blocks.append(np.array(labels, dtype=np.int64))
                for name, at in members.items():
                    contents.cell_sets[name].append(at)
            elif cell in CELL_TYPES:
                for name, at in members.items():
                    if len(at):
                        contents.surfaces.setdefault(name, []).append((cell, cells[at]))
        for name in self.others:
            contents.blocks.append((name, np.empty((0, 0), dtype=np.int64)))
            of_blocks.append(_NONE)
            for sets in contents.cell_sets.values():
                sets.append(_NONE)
        for name, found in contents.cell_sets.items():
            if any(len(rows) for rows in found):
                contents.surfaces.pop(name, None)
        contents.cell_sets = {
            name: found for name, found in contents.cell_sets.items() if name not in contents.surfaces
        }
        return contents

    def _connectivity(self, path: Path, labels: Sequence[int], nodes: Numbering) -> Labels:
        table = np.array([self.elements[label].nodes for label in labels], dtype=np.int64)
        places, known = nodes.places(table)
        if not known.all():
            row, column = np.argwhere(~known)[0]
            raise MeshError(
                f"{path}: element {labels[row]} refers to node {table[row, column]}, which the file does not define."
            )
        return places
