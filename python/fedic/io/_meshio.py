"""Mesh files read and written by meshio."""

import contextlib
import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic.errors import MeshError
from fedic.io._mesh_file import MeshFile

__all__ = ["SET_PREFIX", "read_with_meshio", "write_with_meshio"]

SET_PREFIX = "set:"
"""Fields of this name hold a named set in formats without sets: one for members, zero for others."""

_VOLUMES_ONLY = {".ele", ".node"}
"""Suffixes of TetGen, whose files hold tetrahedra; meshio's reader does not end on other cells."""
_GMSH_TAGS = "gmsh:physical"
_DIMENSIONS = {"vertex": 0, "line": 1}


def read_with_meshio(path: Path) -> MeshFile:
    """Read a mesh file in any format of meshio.

    Named sets are meshio's point and cell sets, the physical groups of Gmsh, and the fields ``set:NAME``.

    Parameters
    ----------
    path : Path
        The file; its suffix tells the format.

    Returns
    -------
    MeshFile
        The contents.

    Raises
    ------
    MeshError
        If meshio cannot read the file.
    """
    with _reported(f"{path}: the mesh file cannot be read"):
        _check_format(path)
        import meshio

        mesh: Any = meshio.read(path)
    blocks = [(str(block.type), np.asarray(block.data, dtype=np.int64)) for block in mesh.cells]
    node_sets = {name: np.asarray(nodes, dtype=np.int64) for name, nodes in mesh.point_sets.items()}
    cell_sets = {
        name: [np.asarray(rows, dtype=np.int64) for rows in members]
        for name, members in mesh.cell_sets.items()
        if not name.startswith("gmsh:") and all(rows is not None for rows in members)
    }
    for name, members in _physical_groups(mesh).items():
        cell_sets.setdefault(name, members)
    for name, values in mesh.point_data.items():
        if name.startswith(SET_PREFIX):
            node_sets[name.removeprefix(SET_PREFIX)] = np.flatnonzero(values)
    for name, members in mesh.cell_data.items():
        if name.startswith(SET_PREFIX):
            cell_sets[name.removeprefix(SET_PREFIX)] = [np.flatnonzero(values) for values in members]
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise MeshError(f"{path}: the file holds nodes of shape {points.shape}, not of 2 or 3 coordinates each.")
    return MeshFile(points, blocks, node_sets, cell_sets)


def write_with_meshio(
    path: Path,
    points: NDArray[np.float64],
    cells: Mapping[str, NDArray[np.int64]],
    node_sets: Mapping[str, NDArray[np.int64]],
    cell_sets: Mapping[str, NDArray[np.int64]],
) -> None:
    """Write a mesh in any format of meshio, with named sets in Abaqus files and with fields ``set:NAME`` in others.

    Parameters
    ----------
    path : Path
        The file; its suffix names the format.
    points : ndarray, shape (n, 3)
        Nodes.
    cells : dict of str to ndarray of int, shape (m, k)
        Cells by type.
    node_sets, cell_sets : dict of str to ndarray of int
        Nodes and cells of the named sets, cells counted over all types.

    Raises
    ------
    MeshError
        If the format is unknown or meshio cannot write the mesh in it.
    """
    with _reported(f"{path}: a mesh cannot be written as {path.suffix!r}"):
        _check_format(path)
        import meshio

        splits = np.cumsum([len(nodes) for nodes in cells.values()])[:-1]
        arrays: dict[str, Any]
        if path.suffix.lower() == ".inp":
            starts = [0, *splits]
            by_block = {name: np.split(rows, np.searchsorted(rows, splits)) for name, rows in cell_sets.items()}
            arrays = {
                "point_sets": dict(node_sets),
                "cell_sets": {
                    name: [rows - start for rows, start in zip(members, starts, strict=True)]
                    for name, members in by_block.items()
                },
            }
        else:
            num_cells = sum(len(nodes) for nodes in cells.values())
            arrays = {
                "point_data": {SET_PREFIX + name: membership(rows, len(points)) for name, rows in node_sets.items()},
                "cell_data": {
                    SET_PREFIX + name: np.split(membership(rows, num_cells), splits) for name, rows in cell_sets.items()
                },
            }
        # Two programs use this suffix, and meshio writes several cell types only in version 2.2 of Gmsh's format.
        file_format = "gmsh22" if path.suffix.lower() == ".msh" else None
        meshio.write(path, meshio.Mesh(points, list(cells.items()), **arrays), file_format)


def membership(members: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return ones for the members of a set and zeros for the others.

    Parameters
    ----------
    members : ndarray of int
        Indices of the members.
    count : int
        Number of nodes or cells of the mesh.

    Returns
    -------
    ndarray of int64, shape (count,)
        The field that stands for the set.
    """
    field = np.zeros(count, dtype=np.int64)
    field[members] = 1
    return field


def _check_format(path: Path) -> None:
    if path.suffix.lower() in _VOLUMES_ONLY:
        raise ValueError("the format holds volumes only")


def _physical_groups(mesh: Any) -> dict[str, list[NDArray[np.int64]]]:
    """Return the named physical groups of a Gmsh file that are not cell sets already (format 2)."""
    tags = mesh.cell_data.get(_GMSH_TAGS)
    if tags is None:
        return {}
    groups = {}
    for name, (tag, dimension) in mesh.field_data.items():
        groups[name] = [
            np.flatnonzero((values == tag) & (_dimension(block.type) == dimension))
            for block, values in zip(mesh.cells, tags, strict=True)
        ]
    return groups


def _dimension(cell: str) -> int:
    kind = cell.rstrip("0123456789")
    return _DIMENSIONS.get(kind, 2 if kind in ("triangle", "quad") else 3)


@contextlib.contextmanager
def _reported(what: str) -> Iterator[None]:
    """Turn whatever meshio raises or prints into a MeshError."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            yield
    except (Exception, SystemExit) as error:  # meshio raises anything, and exits the process on some faults
        reason = said.getvalue().strip() if isinstance(error, SystemExit) else str(error)
        if isinstance(error, KeyError):
            reason = f"{reason} is unknown there"
        reason = " ".join(reason.split()) or type(error).__name__
        raise MeshError(f"{what} ({reason}).") from error
