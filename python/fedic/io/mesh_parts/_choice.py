"""Choice of a part of a mesh file by name."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_TYPES
from fedic.errors import MeshError
from fedic.io._mesh_file import Block, Indices, MeshFile, is_unknown_surface
from fedic.io.mesh_parts._cells import rows_of
from fedic.io.mesh_parts._faces import SOLIDS, boundary_faces
from fedic.io.mesh_parts._repeated import without_repeated_cells

__all__ = ["check_whole", "chosen"]

_PLANE_TOLERANCE = 1e-6
"""Largest distance of a node from the plane it lies in, relative to the size of the mesh."""
_MAX_NAMES = 40


def check_whole(path: Path, contents: MeshFile) -> None:
    """Check that a file of which no part is chosen has surface cells, all of types that are measured.

    Parameters
    ----------
    path : Path
        The file, for messages.
    contents : MeshFile
        Its contents.

    Raises
    ------
    MeshError
        If there is no surface cell, or one of a type that is not measured, or the file is not one mesh.
    """
    if contents.needs_selection:
        raise MeshError(contents.needs_selection)
    _check_types(path, contents.blocks)
    if any(map(len, contents.surface_cells().values())):
        return
    names = _Names(contents)
    others = {name for name, _ in contents.blocks if name not in CELL_TYPES}
    found = ", ".join(sorted(others)) or "none"
    example = names.example()
    if example is None:
        raise MeshError(
            f"{path}: no surface cell to correlate on (cells found: {found}); "
            f"export the surface as one of {', '.join(CELL_TYPES)}."
        )
    raise MeshError(
        f"{path}: no surface cell to correlate on (cells found: {found}); choose faces of the solids by name, such as "
        f"{path.name}#{example}. Names: {names.listed()}."
    )


def chosen(path: Path, contents: MeshFile, name: str) -> MeshFile:
    """Return the part of a mesh file that a name chooses.

    The name is that of a set of cells, a part or named faces of solids; of a set of nodes, which stands for the surface
    cells, or else the faces of solids, all of whose nodes are in the set; or ``x-min``, ``x-max``, ``y-min`` and so on:
    the cells or faces in that side of the bounding box. Case counts only if two names differ by nothing else.

    Parameters
    ----------
    path : Path
        The file, for messages.
    contents : MeshFile
        Its contents.
    name : str
        The choice.

    Returns
    -------
    MeshFile
        All nodes, the chosen surface cells, and the sets restricted to them.

    Raises
    ------
    MeshError
        If the file has no such name, or nothing of that name has surface cells.
    """
    names = _Names(contents)
    found = names.matching(name)
    if not found:
        raise MeshError(f"{path}: the file holds nothing named {name!r} to choose; it holds {names.listed()}.")
    if len(found) > 1:
        raise MeshError(f"{path}: {name!r} could mean any of {', '.join(map(repr, found))}; write it as in the file.")
    (name,) = found
    rows = names.cells(name)
    if any(map(len, rows)):
        part = _restricted(contents, rows)
    else:
        faces = names.faces(name)
        if not faces:
            raise MeshError(
                f"{path}: {name!r} chooses {names.described(name)}, so there is nothing to correlate on; the names "
                f"in the file are {names.listed()}."
            )
        part = _restricted(contents, [np.empty(0, dtype=np.int64)] * len(contents.blocks), faces)
    _check_types(path, part.blocks)
    return without_repeated_cells(part)


class _Names:
    """The names in a file that choose a part of it."""

    def __init__(self, contents: MeshFile) -> None:
        self._contents = contents
        self._boundary: list[Block] | None = None
        named = [*contents.cell_sets, *contents.parts, *contents.surfaces, *contents.node_sets]
        self._used = contents.points[_nodes_of_faces(contents.blocks)]
        self._sides = [side for side in _sides(self._used) if side not in named]
        self._names = list(dict.fromkeys([*named, *self._sides]))

    def matching(self, name: str) -> list[str]:
        if name in self._names:
            return [name]
        return [each for each in self._names if each.casefold() == name.casefold()]

    def cells(self, name: str) -> list[Indices]:
        """Return the surface cells of a name: for each block, indices in the block."""
        blocks = self._contents.blocks
        for members in (self._contents.cell_sets.get(name), self._contents.parts.get(name)):
            surface = [
                rows if _is_surface(cell) else rows[:0] for (cell, _), rows in zip(blocks, members or [], strict=False)
            ]
            if any(map(len, surface)):
                return surface
        if name in self._contents.surfaces:
            return rows_of(self._contents.surfaces[name], blocks)
        inside = self._nodes(name)
        if inside is None:
            return []
        return [np.flatnonzero(inside[nodes].all(axis=1) & _is_surface(cell)) for cell, nodes in blocks]

    def faces(self, name: str) -> list[Block]:
        """Return the faces of solids of a name."""
        if name in self._contents.surfaces:
            return self._contents.surfaces[name]
        inside = self._nodes(name)
        if inside is None:
            return []
        if self._boundary is None:
            self._boundary = list(boundary_faces(self._contents.blocks).items())
        found = [(cell, nodes[inside[nodes].all(axis=1)]) for cell, nodes in self._boundary]
        return [(cell, nodes) for cell, nodes in found if len(nodes)]

    def described(self, name: str) -> str:
        """Say what a name holds, such as "12 surface cells"."""
        count = sum(map(len, self.cells(name)))
        if count:
            return f"{count} surface cell{'s' * (count > 1)}"
        count = sum(len(nodes) for _, nodes in self.faces(name))
        if count:
            return f"{count} face{'s' * (count > 1)} of solids"
        counts: dict[str, int] = {}
        members = self._contents.cell_sets.get(name) or self._contents.parts.get(name) or []
        for (cell, _), rows in zip(self._contents.blocks, members, strict=False):
            counts[cell] = counts.get(cell, 0) + len(rows)
        cells = [f"{count} {cell} cell{'s' * (count > 1)}" for cell, count in counts.items() if count]
        return "no surface cell" + f" but {', '.join(cells)}" * bool(cells)

    def listed(self) -> str:
        """List the names, those with something to correlate on first."""
        described = [(name, self.described(name)) for name in self._names]
        useful = [each for each in described if not each[1].startswith("no ")]
        other = [each for each in described if each[1].startswith("no ") and each[0] not in self._sides]
        shown = [f"{name} ({what})" for name, what in useful + other]
        if len(shown) > _MAX_NAMES:
            shown = [*shown[:_MAX_NAMES], f"and {len(shown) - _MAX_NAMES} more"]
        return ", ".join(shown) or "no named part"

    def example(self) -> str | None:
        """Return a name that chooses faces of solids."""
        return next((name for name in self._names if self.faces(name)), None)

    def _nodes(self, name: str) -> NDArray[np.bool_] | None:
        """Return which nodes belong to a set of nodes or a side of the bounding box."""
        points = self._contents.points
        if name in self._contents.node_sets:
            inside = np.zeros(len(points), dtype=bool)
            inside[self._contents.node_sets[name]] = True
            return inside
        if name not in self._sides:
            return None
        axis = "xyz".index(name[0])
        side = self._used[:, axis].min() if name.endswith("min") else self._used[:, axis].max()
        return np.asarray(np.abs(points[:, axis] - side) <= _PLANE_TOLERANCE * _size(self._used))


def _nodes_of_faces(blocks: list[Block]) -> Indices:
    """Return the nodes of the surface cells and solids."""
    wanted = [nodes.ravel() for cell, nodes in blocks if _is_surface(cell) or cell in SOLIDS]
    return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *wanted]))


def _size(points: NDArray[np.float64]) -> float:
    return float(np.ptp(points, axis=0).max())


def _sides(points: NDArray[np.float64]) -> list[str]:
    """Return the names of the sides of the bounding box, without those of a direction in which it is flat."""
    if not len(points):
        return []
    extents = np.ptp(points, axis=0) > _PLANE_TOLERANCE * _size(points)
    axes = [axis for axis, is_wide in zip("xyz", extents, strict=False) if is_wide]
    return [f"{axis}-{end}" for axis in axes for end in ("min", "max")]


def _is_surface(cell: str) -> bool:
    return cell in CELL_TYPES or is_unknown_surface(cell)


def _check_types(path: Path, blocks: list[Block]) -> None:
    unknown = sorted({cell for cell, nodes in blocks if len(nodes) and is_unknown_surface(cell)})
    if unknown:
        raise MeshError(
            f"{path}: surface cells of type {', '.join(unknown)} are not measured; export the surface as one of "
            f"{', '.join(CELL_TYPES)}."
        )


def _restricted(contents: MeshFile, rows: list[Indices], faces: Sequence[Block] = ()) -> MeshFile:
    """Return some surface cells of a file, or faces of its solids, and of the sets what belongs to them."""
    cells = [(cell, nodes[at]) for (cell, nodes), at in zip(contents.blocks, rows, strict=True)]
    used = np.zeros(len(contents.points), dtype=bool)
    for _, nodes in [*cells, *faces]:
        used[nodes] = True
    node_sets = {name: nodes[used[nodes]] for name, nodes in contents.node_sets.items()}
    cell_sets = {}
    for name, members in contents.cell_sets.items():
        places = [np.flatnonzero(np.isin(at, each)) for at, each in zip(rows, members, strict=False)]
        cell_sets[name] = [*places, *(np.empty(0, dtype=np.int64) for _ in faces)]
        if name not in node_sets:
            of_cells = [nodes[at].ravel() for (_, nodes), at in zip(cells, places, strict=False)]
            others = [
                nodes[each].ravel()
                for (cell, nodes), each in zip(contents.blocks, members, strict=False)
                if not _is_surface(cell)
            ]
            nodes = np.unique(np.concatenate([*of_cells, *others]))
            node_sets[name] = nodes[used[nodes]]
    labels = contents.cell_labels
    return MeshFile(
        contents.points,
        [*cells, *faces],
        node_sets,
        cell_sets,
        node_labels=contents.node_labels,
        cell_labels=None if labels is None or faces else [each[at] for each, at in zip(labels, rows, strict=True)],
    )
