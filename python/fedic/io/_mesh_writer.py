"""Writing meshes, with a check that the file holds all of the mesh."""

import tempfile
from pathlib import Path

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import StrPath
from fedic.errors import FedicError, MeshError
from fedic.io.mesh_formats import mesh_writer
from fedic.io.meshes import read_mesh

__all__ = ["write_mesh"]

_COORDINATE_TOLERANCE = 1e-9
"""Largest rounding of a coordinate by a text format, relative to the size of the mesh."""


def write_mesh(path: StrPath, mesh: Mesh) -> None:
    """Write a mesh; this is `Mesh.write`.

    Parameters
    ----------
    path : str or path
        The file; its suffix names the format.
    mesh : Mesh
        The mesh.

    Raises
    ------
    MeshError
        If the format is unknown or cannot hold the mesh.
    FedicError
        If the file cannot be written.
    """
    path = Path(path)
    points, cells, sets = mesh.points, mesh.cells, mesh.sets
    points = np.ascontiguousarray(np.pad(points, ((0, 0), (0, 3 - points.shape[1]))))
    node_sets = {name: each.nodes for name, each in sets.items()}
    cell_sets = {name: each.cells for name, each in sets.items() if len(each.cells)}
    try:
        # Some formats write several files that name each other: they are written under their final names.
        with tempfile.TemporaryDirectory(prefix=f".{path.stem}-", dir=path.parent) as folder:
            temporary = Path(folder, path.name)
            mesh_writer(path, mesh.node_labels, mesh.cell_labels)(temporary, points, cells, node_sets, cell_sets)
            _check(temporary, path, mesh)
            for written in Path(folder).iterdir():
                written.replace(path.parent / written.name)
    except MeshError as error:
        raise MeshError(str(error).replace(str(temporary), str(path))) from error
    except FileNotFoundError as error:
        raise FedicError(f"{path}: the folder {path.parent} does not exist; make it first.") from error
    except OSError as error:
        raise FedicError(f"{path}: the file cannot be written ({error.strerror}).") from error


def _check(written: Path, path: Path, mesh: Mesh) -> None:
    """Refuse a file that does not read back as the mesh."""

    def refusal(lost: str) -> MeshError:
        return MeshError(f"{path}: the format {path.suffix!r} does not hold {lost}; write '.vtu' instead.")

    try:
        read = read_mesh(written)
    except MeshError as error:
        reason = str(error).removeprefix(f"{written}: ").rstrip(".")
        raise refusal(f"this mesh ({reason})") from error
    points, read_points = (np.pad(each.points, ((0, 0), (0, 3 - each.points.shape[1]))) for each in (mesh, read))
    if points.shape != read_points.shape:
        raise refusal("all the nodes of this mesh")
    tolerance = _COORDINATE_TOLERANCE * float(np.ptp(points, axis=0).max())
    if np.abs(points - read_points).max() > tolerance:
        raise refusal("the coordinates of this mesh to enough digits")
    cells = read.cells
    for name, nodes in mesh.cells.items():
        if name not in cells or not np.array_equal(cells[name], nodes):
            raise refusal(f"the {name} cells of this mesh")
    if list(cells) != list(mesh.cells):
        raise refusal("the cells of this mesh in order")
    sets = read.sets
    lost = [name for name, each in mesh.sets.items() if sets.get(name) != each]
    if lost:
        raise refusal(f"the named sets of this mesh ({', '.join(lost)})")
