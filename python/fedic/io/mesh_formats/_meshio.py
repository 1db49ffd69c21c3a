"""Mesh files read and written by meshio."""

import contextlib
import io
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic.errors import MeshError
from fedic.io._mesh_file import MeshFile, unreadable
from fedic.io.mesh_formats._set_fields import SET_PREFIX, membership, set_fields

__all__ = ["FORMATS", "read_with_meshio", "write_with_meshio"]

FORMATS = {
    ".avs": "avsucd",
    ".dat": "tecplot",
    ".mesh": "medit",
    ".meshb": "medit",
    ".obj": "obj",
    ".off": "off",
    ".ply": "ply",
    ".stl": "stl",
    ".tec": "tecplot",
    ".vol": "netgen",
    ".xml": "dolfin-xml",
}
"""Formats that meshio reads for fedic, by suffix; its other readers lose cells or fail on valid files."""

_ZONE = re.compile(rb"(?im)^\s*ZONE\b")
_PREFIX = re.compile(r"\bError: |Couldn't read file .* as \S+$")
"""What meshio adds to the cause."""
_TAGS = ("avsucd:material", "medit:ref", "netgen:index", "obj:group_ids")
"""Fields that number the parts of a mesh."""


def read_with_meshio(path: Path) -> MeshFile:
    """Read a mesh file in one of the formats of `FORMATS`.

    Named sets are meshio's point and cell sets, and the fields ``set:NAME``. Numbered parts can be chosen.

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
    name = FORMATS[path.suffix.lower()]
    if name == "tecplot" and len(_ZONE.findall(path.read_bytes())) > 1:
        raise unreadable(path, "it has several zones; save the zone of the surface alone")
    with _reported(
        f"{path}: the mesh file cannot be read",
        f"the file is damaged, or of a variant of {name} that meshio does not read",
        " Save the mesh as VTK (.vtu), or in Gmsh as .msh.",
    ):
        import meshio

        mesh: Any = meshio.read(path, name)
        points = np.asarray(mesh.points, dtype=np.float64)
        blocks = [_block(str(block.type), block.data) for block in mesh.cells]
        node_sets = {name: np.asarray(nodes, dtype=np.int64) for name, nodes in mesh.point_sets.items()}
        cell_sets = {
            name: [np.asarray(rows, dtype=np.int64) for rows in members]
            for name, members in mesh.cell_sets.items()
            if all(rows is not None for rows in members)
        }
        for name, values in mesh.point_data.items():
            if name.startswith(SET_PREFIX):
                node_sets[name.removeprefix(SET_PREFIX)] = np.flatnonzero(values)
        for name, members in mesh.cell_data.items():
            if name.startswith(SET_PREFIX):
                cell_sets[name.removeprefix(SET_PREFIX)] = [np.flatnonzero(values) for values in members]
        parts = {
            str(number): [np.flatnonzero(np.asarray(values) == number) for values in mesh.cell_data[tag]]
            for tag in _TAGS
            if tag in mesh.cell_data
            for number in np.unique(np.concatenate(mesh.cell_data[tag])).tolist()
        }
    if not points.size:
        raise unreadable(path, "it holds no nodes")
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise MeshError(f"{path}: the file holds nodes of shape {points.shape}, not of 2 or 3 coordinates each.")
    return MeshFile(points, blocks, node_sets, cell_sets, parts=parts)


def _block(name: str, nodes: Any) -> tuple[str, NDArray[np.int64]]:
    array = np.asarray(nodes, dtype=np.int64)
    if array.ndim != 2:
        raise ValueError(f"the {name} cells have different numbers of nodes")
    return name, array


def write_with_meshio(
    path: Path,
    points: NDArray[np.float64],
    cells: Mapping[str, NDArray[np.int64]],
    node_sets: Mapping[str, NDArray[np.int64]],
    cell_sets: Mapping[str, NDArray[np.int64]],
) -> None:
    """Write a mesh in any format of meshio, with named sets in MED files, and fields ``set:NAME`` in others.

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
        if path.suffix.lower() in {".ele", ".node"}:
            raise ValueError("the format holds volumes only")
        import meshio

        splits = np.cumsum([len(nodes) for nodes in cells.values()])[:-1]
        num_cells = sum(len(nodes) for nodes in cells.values())
        mesh = meshio.Mesh(points, list(cells.items()))
        if path.suffix.lower() == ".med":
            tags, mesh.point_tags = _families(node_sets, len(points))
            mesh.point_data = {"point_tags": tags}
            tags, mesh.cell_tags = _families(cell_sets, num_cells)
            mesh.cell_data = {"cell_tags": np.split(-tags, splits)}
            mesh.cell_tags = {-tag: names for tag, names in mesh.cell_tags.items()}
        else:
            mesh.point_data = set_fields(node_sets, len(points))
            mesh.cell_data = {
                name: np.split(values, splits) for name, values in set_fields(cell_sets, num_cells).items()
            }
        # Two programs use this suffix, and meshio writes several cell types only in version 2.2 of Gmsh's format.
        file_format = "gmsh22" if path.suffix.lower() == ".msh" else None
        meshio.write(path, mesh, file_format)


def _families(sets: Mapping[str, NDArray[np.int64]], count: int) -> tuple[NDArray[np.int64], dict[int, list[str]]]:
    """Return MED's families: the number of that of each node or cell, and the names of the sets of each family."""
    if not sets:
        return np.zeros(count, dtype=np.int64), {}
    members = np.stack([membership(rows, count) for rows in sets.values()])
    kinds, family = np.unique(members, axis=1, return_inverse=True)
    number = np.cumsum(kinds.any(axis=0)) * kinds.any(axis=0)
    names = list(sets)
    named = {int(number[k]): [names[i] for i in np.flatnonzero(kinds[:, k])] for k in np.flatnonzero(number)}
    return number[family.ravel()], named


@contextlib.contextmanager
def _reported(what: str, cause: str | None = None, advice: str = "") -> Iterator[None]:
    """Turn whatever meshio raises or prints into a MeshError.

    meshio says what is wrong in errors of its own. Of its other errors, which are those of Python, the cause is said.
    """
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            yield
    except ImportError as error:
        raise MeshError(f"{what}: it needs a library that is not installed ({error}).") from error
    except (Exception, SystemExit) as error:  # meshio raises anything, and exits the process on some faults
        reason = said.getvalue() if isinstance(error, SystemExit) else str(error)
        if cause is not None and not (isinstance(error, SystemExit) or type(error).__module__.startswith("meshio")):
            reason = cause
        elif isinstance(error, KeyError):
            reason = f"{reason} is unknown there"
        reason = _PREFIX.sub("", " ".join(reason.split())).strip() or cause or type(error).__name__
        raise MeshError(f"{what} ({reason.rstrip('.')}).{advice}") from error
