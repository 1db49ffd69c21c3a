"""Reading meshes written by other programs."""

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import CELL_NAMES, StrPath
from fedic.errors import MeshError
from fedic.io._abaqus import read_abaqus

__all__ = ["read_mesh"]


def read_mesh(path: StrPath) -> Mesh:
    """Read the surface cells of a mesh file.

    Abaqus input files are read by fedic, all other formats (Gmsh, VTK, VTU, MED, Nastran, ...) by meshio. Cells of the
    kinds triangle, triangle6, quad, quad8 and quad9 are kept; points, lines and volumes are left out.

    Parameters
    ----------
    path : str or path
        The mesh file; its suffix tells the format.

    Returns
    -------
    Mesh
        With all nodes of the file, in the file's order and unit, so that node ``i`` is still the ``i``-th of the file.
        Nodes are 2-D when every ``z`` is zero, 3-D otherwise.

    Raises
    ------
    MeshError
        If the file is missing, cannot be read, or holds no surface cell.
    """
    path = Path(path)
    if not path.is_file():
        raise MeshError(f"{path}: there is no such mesh file; check the path.")
    points, blocks = read_abaqus(path) if path.suffix.lower() == ".inp" else _read_with_meshio(path)

    names = list(dict.fromkeys(name for name, _ in blocks if name in CELL_NAMES))
    if not names:
        found = ", ".join(sorted({name for name, _ in blocks})) or "none"
        raise MeshError(
            f"{path}: no surface cell to correlate on (cells found: {found}); "
            f"export the surface as one of {', '.join(CELL_NAMES)}."
        )
    cells = {name: np.concatenate([nodes for kind, nodes in blocks if kind == name]) for name in names}
    if points.shape[1] == 3 and not points[:, 2].any():
        points = points[:, :2]
    try:
        return Mesh(np.ascontiguousarray(points, dtype=np.float64), cells)
    except MeshError as error:
        raise MeshError(f"{path}: {error}", error.cells, error.nodes) from error


def _read_with_meshio(path: Path) -> tuple[NDArray[np.float64], list[tuple[str, NDArray[np.int64]]]]:
    import meshio

    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh: Any = meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio's readers raise anything, and exit the process on some faults
        reason = said.getvalue().strip() if isinstance(error, SystemExit) else str(error)
        reason = " ".join(reason.split()) or type(error).__name__
        raise MeshError(f"{path}: the mesh file cannot be read ({reason}).") from error
    points = np.asarray(mesh.points, dtype=np.float64)
    return points, [(block.type, np.asarray(block.data, dtype=np.int64)) for block in mesh.cells]
