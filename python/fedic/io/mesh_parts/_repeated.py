"""Cells that a file holds more than once."""

import numpy as np

from fedic._core import CELL_TYPES
from fedic.io._mesh_file import Indices, MeshFile
from fedic.io.mesh_parts._cells import corner_keys, groups_of
from fedic.io.mesh_parts._faces import SOLIDS

__all__ = ["without_repeated_cells"]


def without_repeated_cells(contents: MeshFile) -> MeshFile:
    """Return the contents with each cell once, a member of all the sets of its copies.

    Two surface cells, or two solids, are one cell if they have the same corners, in whatever order. The copy with most
    nodes is kept, or else the first.

    Parameters
    ----------
    contents : MeshFile
        The contents of a file.

    Returns
    -------
    MeshFile
        The same object if no cell is repeated.
    """
    kept = _kept_copies(contents)
    if (kept == np.arange(len(kept))).all():
        return contents
    rows_of_block = np.cumsum([0, *(len(nodes) for _, nodes in contents.blocks)])
    stays = np.unique(kept)
    new_index = np.cumsum(np.isin(np.arange(len(kept)), stays)) - 1
    rows = [
        stays[(stays >= start) & (stays < start + len(nodes))] - start
        for (_, nodes), start in zip(contents.blocks, rows_of_block, strict=False)
    ]
    new_blocks = [(name, nodes[kept_rows]) for (name, nodes), kept_rows in zip(contents.blocks, rows, strict=True)]
    labels = contents.cell_labels
    new_starts = np.cumsum([0, *(len(nodes) for _, nodes in new_blocks)])

    def moved(members: list[Indices]) -> list[Indices]:
        old = [start + each for start, each in zip(rows_of_block, members, strict=False)]
        new = np.unique(new_index[kept[np.concatenate([np.empty(0, dtype=np.int64), *old])]])
        parts = np.split(new, np.searchsorted(new, new_starts[1:-1]))
        return [part - start for part, start in zip(parts, new_starts, strict=False)]

    return MeshFile(
        contents.points,
        new_blocks,
        contents.node_sets,
        {name: moved(members) for name, members in contents.cell_sets.items()},
        contents.surfaces,
        {name: moved(members) for name, members in contents.parts.items()},
        contents.needs_selection,
        contents.node_labels,
        None if labels is None else [each[kept_rows] for each, kept_rows in zip(labels, rows, strict=True)],
    )


def _kept_copies(contents: MeshFile) -> Indices:
    """Return for each cell of the file, counted over all blocks, the copy that is kept."""
    starts = np.cumsum([0, *(len(nodes) for _, nodes in contents.blocks)])
    kept = np.arange(starts[-1])
    corners = {name: cell.num_corners for name, cell in CELL_TYPES.items()}
    for counts, width in ((corners, 4), (SOLIDS, 8)):
        found = [
            (start, nodes, counts[name])
            for (name, nodes), start in zip(contents.blocks, starts, strict=False)
            if name in counts
        ]
        if not found:
            continue
        group = groups_of(np.concatenate([corner_keys(nodes, count, width) for _, nodes, count in found]))
        cells = np.concatenate([start + np.arange(len(nodes)) for start, nodes, _ in found])
        sizes = np.concatenate([np.full(len(nodes), nodes.shape[1]) for _, nodes, _ in found])
        order = np.lexsort((cells, -sizes, group))
        first = order[np.searchsorted(group[order], np.arange(group.max(initial=-1) + 1))]
        kept[cells] = cells[first[group]]
    return kept
