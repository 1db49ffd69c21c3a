"""Contents of a mesh file, as the readers of the formats return it."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES, MeshSet
from fedic.errors import MeshError

__all__ = ["Block", "Indices", "MeshFile", "is_unknown_surface", "unreadable"]

Indices = NDArray[np.int64]
Block = tuple[str, Indices]
"""Name of a type of cells, and the nodes of its cells, shape (m, k)."""

_SURFACE_FAMILIES = ("triangle", "quad", "polygon")


@dataclass
class MeshFile:
    """Nodes, cells and sets of a mesh file.

    Attributes
    ----------
    points : ndarray, shape (n, 2) or (n, 3)
        Nodes in the order of the file.
    blocks : list of (str, ndarray of int, shape (m, k))
        Cells of one type each: surface cells under their name in `CELL_TYPES`, lines and solids under meshio's name
        and in its order of nodes, others under any other name.
    node_sets : dict of str to ndarray of int
        Nodes of each named set.
    cell_sets : dict of str to list of ndarray of int
        Cells of each named set: for each block, indices in the block.
    surfaces : dict of str to list of (str, ndarray of int, shape (m, k))
        Surface cells that are no part of the mesh as a whole and can be chosen by name: named faces of solids, for
        instance.
    parts : dict of str to list of ndarray of int
        As `cell_sets`: blocks and numbered groups, which can be chosen by name and are no sets of the mesh.
    node_labels : ndarray of int, shape (n,), or None
        Number of each node in the file, if the file numbers them.
    cell_labels : list of ndarray of int, or None
        For each block, the number of each of its cells.
    needs_selection : str
        Why the file as a whole is not one mesh, and what can be chosen; empty if it is one.
    """

    points: NDArray[np.float64]
    blocks: list[Block]
    node_sets: dict[str, Indices] = field(default_factory=dict)
    cell_sets: dict[str, list[Indices]] = field(default_factory=dict)
    surfaces: dict[str, list[Block]] = field(default_factory=dict)
    parts: dict[str, list[Indices]] = field(default_factory=dict)
    needs_selection: str = ""
    node_labels: Indices | None = None
    cell_labels: list[Indices] | None = None

    def surface_cells(self) -> dict[str, Indices]:
        """Return the surface cells by type, in the order in which the types first appear.

        Returns
        -------
        dict of str to ndarray of int, shape (m, k)
            Blocks of one type are joined.
        """
        return joined([block for block in self.blocks if block[0] in CELL_TYPES])

    def sets(self) -> dict[str, MeshSet]:
        """Return the named sets, their cells numbered as in `surface_cells`.

        Returns
        -------
        dict of str to MeshSet
            A set without nodes of its own gets the nodes of its cells, also of those that are not surface cells: of the
            lines of a boundary, for instance. Sets without nodes are left out.
        """
        starts = self._starts()
        sets = {}
        for name in [*self.node_sets, *(name for name in self.cell_sets if name not in self.node_sets)]:
            members = list(zip(self.blocks, starts, self.cell_sets.get(name, []), strict=False))
            nodes = self.node_sets.get(name)
            if nodes is None:
                nodes = np.unique(np.concatenate([block[1][rows].ravel() for block, _, rows in members]))
            cells = [start + rows for _, start, rows in members if start is not None]
            if len(nodes):
                sets[name] = MeshSet(nodes, np.concatenate([np.empty(0, dtype=np.int64), *cells]))
        return sets

    def labels(self) -> tuple[Indices | None, Indices | None]:
        """Return the labels of the nodes and of the surface cells, in the order of `surface_cells`.

        Returns
        -------
        node_labels, cell_labels : ndarray of int, or None
            None if the file has none, two are equal, as in several instances of a part, or one is not positive.
        """
        cells = None
        if self.cell_labels is not None:
            of_blocks = [(name, labels) for (name, _), labels in zip(self.blocks, self.cell_labels, strict=True)]
            surface = joined([block for block in of_blocks if block[0] in CELL_TYPES])
            cells = np.concatenate([np.empty(0, dtype=np.int64), *surface.values()])
        return _valid_labels(self.node_labels), _valid_labels(cells)

    def check_nodes(self, path: Path) -> None:
        """Check that the cells and sets refer to nodes of the file.

        Parameters
        ----------
        path : Path
            The file, for the message.

        Raises
        ------
        MeshError
            If a cell, face or set has a node that does not exist.
        """
        faces = [block for blocks in self.surfaces.values() for block in blocks]
        for name, nodes in [*self.blocks, *faces]:
            outside = (nodes < 0) | (nodes >= len(self.points))
            if outside.any():
                row, column = np.argwhere(outside)[0]
                raise MeshError(
                    f"{path}: the {name} cell {row} refers to node {nodes[row, column]} (counted from 0), but the file "
                    f"has {len(self.points)} nodes; the file is damaged."
                )
        for name, nodes in self.node_sets.items():
            if len(nodes) and (nodes.min() < 0 or nodes.max() >= len(self.points)):
                raise MeshError(
                    f"{path}: the set {name!r} refers to a node that the file does not have; the file is damaged."
                )

    def _starts(self) -> list[int | None]:
        """Return the index of the first cell of each block, None for blocks without surface cells."""
        sizes = {name: len(nodes) for name, nodes in self.surface_cells().items()}
        next_cell = dict(zip(sizes, np.cumsum([0, *sizes.values()]), strict=False))
        starts: list[int | None] = []
        for name, nodes in self.blocks:
            starts.append(int(next_cell[name]) if name in next_cell else None)
            if name in next_cell:
                next_cell[name] += len(nodes)
        return starts


def _valid_labels(labels: Indices | None) -> Indices | None:
    if labels is None or len(np.unique(labels)) < len(labels) or labels.min(initial=1) < 1:
        return None
    return labels


def joined(blocks: list[Block]) -> dict[str, Indices]:
    """Join blocks of one type.

    Parameters
    ----------
    blocks : list of (str, ndarray of int, shape (m, k) or (m,))
        Cells, or their labels.

    Returns
    -------
    dict of str to ndarray of int, shape (m, k) or (m,)
        The types in the order in which they first appear.
    """
    names = dict.fromkeys(name for name, _ in blocks)
    return {name: np.concatenate([nodes for each, nodes in blocks if each == name]) for name in names}


def is_unknown_surface(name: str) -> bool:
    """Return whether cells of this name are surface cells that fedic does not measure on.

    Parameters
    ----------
    name : str
        Name of a type of cells.

    Returns
    -------
    bool
        True for instance for ``"triangle10"`` and ``"polygon"``.
    """
    return name not in CELL_TYPES and name.startswith(_SURFACE_FAMILIES)


def unreadable(path: Path, reason: str) -> MeshError:
    """Return the error of a file that cannot be read.

    Parameters
    ----------
    path : Path
        The file.
    reason : str
        What is wrong, without a full stop at its end.

    Returns
    -------
    MeshError
        To be raised.
    """
    return MeshError(f"{path}: the mesh file cannot be read ({reason}).")
