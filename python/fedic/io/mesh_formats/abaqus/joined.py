"""Several meshes as one."""

from collections.abc import Sequence

import numpy as np

from fedic.io._mesh_file import MeshFile

__all__ = ["joined"]

_NONE = np.empty(0, dtype=np.int64)


def joined(files: Sequence[MeshFile]) -> MeshFile:
    """Return the contents of several meshes as one; sets, parts and surfaces of one name are joined.

    Parameters
    ----------
    files : sequence of MeshFile
        The meshes, with points of 3 coordinates.

    Returns
    -------
    MeshFile
        With the nodes and blocks of all, in their order.
    """
    whole = MeshFile(np.concatenate([np.empty((0, 3)), *(file.points for file in files)]), [])
    whole.node_labels = np.concatenate([_NONE, *(file.node_labels for file in files if file.node_labels is not None)])
    whole.cell_labels = [labels for file in files for labels in file.cell_labels or []]
    num_blocks = sum(len(file.blocks) for file in files)
    start = 0
    for file in files:
        first = len(whole.blocks)
        whole.blocks += [(name, nodes + start) for name, nodes in file.blocks]
        for name, nodes in file.node_sets.items():
            whole.node_sets[name] = np.concatenate([whole.node_sets.get(name, _NONE), nodes + start])
        for named, source in ((whole.cell_sets, file.cell_sets), (whole.parts, file.parts)):
            for name, members in source.items():
                rows = named.setdefault(name, [_NONE] * num_blocks)
                rows[first : first + len(members)] = members
        for name, cells in file.surfaces.items():
            whole.surfaces.setdefault(name, []).extend((cell, nodes + start) for cell, nodes in cells)
        start += len(file.points)
    return whole
