"""Contents of a mesh file, as the readers of the formats return it."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES, MeshSet

__all__ = ["MeshFile"]

Indices = NDArray[np.int64]


@dataclass
class MeshFile:
    """Nodes, cells and sets of a mesh file.

    Attributes
    ----------
    points : ndarray, shape (n, 2) or (n, 3)
        Nodes in the order of the file.
    blocks : list of (str, ndarray of int, shape (m, k))
        Cells of one type each: surface cells under their name in `CELL_TYPES`, lines and volumes under their name in
        meshio (``"line"``, ``"tetra10"``, ``"hexahedron20"``), others under any other name.
    node_sets : dict of str to ndarray of int
        Nodes of each named set.
    cell_sets : dict of str to list of ndarray of int
        Cells of each named set: for each block, indices in the block.
    surfaces : dict of str to list of (str, ndarray of int, shape (m, k))
        Named faces of solids and rigid parts as surface cells, used only if they are chosen by name.
    parts : dict of str to list of ndarray of int
        As `cell_sets`: blocks and numbered groups, which can be chosen by name and are no sets of the mesh.
    needs_selection : str
        Why the file as a whole is not one mesh, and what can be selected; empty if it is one.
    """

    points: NDArray[np.float64]
    blocks: list[tuple[str, Indices]]
    node_sets: dict[str, Indices] = field(default_factory=dict)
    cell_sets: dict[str, list[Indices]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, Indices]]] = field(default_factory=dict)
    parts: dict[str, list[Indices]] = field(default_factory=dict)
    needs_selection: str = ""

    def surface_cells(self) -> dict[str, Indices]:
        """Return the surface cells by type, in the order in which the types first appear.

        Returns
        -------
        dict of str to ndarray of int, shape (m, k)
            Blocks of one type are joined.
        """
        names = dict.fromkeys(name for name, _ in self.blocks if name in CELL_TYPES)
        return {name: np.concatenate([nodes for each, nodes in self.blocks if each == name]) for name in names}

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
