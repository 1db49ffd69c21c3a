"""The process that runs Gmsh, as seen from the parent."""

import io
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic._core import CellType
from fedic._internal.types import Floats
from fedic.errors import MeshError

__all__ = ["check_gmsh", "mesh_polygons"]

_PROGRAM = Path(__file__).with_name("_gmsh_process.py")
_FRONTAL_DELAUNAY, _FRONTAL_DELAUNAY_FOR_QUADS = 6, 8
_BLOSSOM = 1
_NO_SUBDIVISION = 0
_REFUSED = 3


def check_gmsh() -> None:
    """Check that Gmsh is installed.

    Raises
    ------
    MeshError
        If it is not.
    """
    try:
        found = find_spec("gmsh")
    except ValueError:
        found = None
    if not sys.executable:
        raise MeshError("unstructured_mesh runs Gmsh in another process, but sys.executable names no Python.")
    if found is None:
        raise MeshError("unstructured_mesh needs Gmsh, which is not installed: pip install fedic[gmsh]")


def mesh_polygons(
    polygons: Sequence[Floats], size: float, cell_type: CellType
) -> tuple[NDArray[np.int64], Floats, NDArray[np.int64]]:
    """Mesh the inside of polygons in a process of its own, which Ctrl-C ends.

    Parameters
    ----------
    polygons : sequence of ndarray, shape (n, 2)
        The outline and the holes.
    size : float
        Length of the edges.
    cell_type : CellType
        Type of the cells.

    Returns
    -------
    tags : ndarray of int, shape (n,)
    coordinates : ndarray, shape (n, 3)
    connectivity : ndarray of int, shape (m, k)
        Tags of the nodes of the cells.

    Raises
    ------
    MeshError
        If Gmsh reports a fault or its process ends.
    """
    quads = not cell_type.is_triangle
    task = {
        "path": [str(folder) for folder in sys.path],
        "polygons": [polygon.tolist() for polygon in polygons],
        "size": size,
        "family": "Quadrangle" if quads else "Triangle",
        "order": cell_type.gmsh_order,
        "incomplete": cell_type.gmsh_incomplete,
        "options": {
            "General.Terminal": 0.0,
            "Mesh.Algorithm": float(_FRONTAL_DELAUNAY_FOR_QUADS if quads else _FRONTAL_DELAUNAY),
            "Mesh.RecombineAll": float(quads),
            "Mesh.RecombinationAlgorithm": float(_BLOSSOM),
            "Mesh.SubdivisionAlgorithm": float(_NO_SUBDIVISION),
            "Mesh.ElementOrder": float(cell_type.gmsh_order or 1),
            "Mesh.SecondOrderIncomplete": float(cell_type.gmsh_incomplete),
        },
    }
    status, output, messages = _run(json.dumps(task).encode() + b"\n")
    if status == _REFUSED:
        raise MeshError(f"unstructured_mesh: Gmsh could not mesh the polygon ({messages.strip()}).")
    if status != 0 and "OSError" in messages:
        raise MeshError(
            "unstructured_mesh needs Gmsh (pip install fedic[gmsh]); it is installed but a system library it needs is "
            f"missing ({messages.strip().splitlines()[-1]})."
        )
    if status != 0:
        last = (messages.strip().splitlines() or ["no message"])[-1]
        raise MeshError(f"unstructured_mesh: the process of Gmsh ended with status {status} ({last}).")
    arrays = np.load(io.BytesIO(output), allow_pickle=False)
    return (
        arrays["tags"].astype(np.int64),
        arrays["coordinates"].astype(np.float64).reshape(-1, 3),
        arrays["connectivity"].astype(np.int64).reshape(-1, cell_type.num_nodes),
    )


def _run(task: bytes) -> tuple[int, bytes, str]:
    """Return the exit status, the output and the messages of the process."""
    with tempfile.TemporaryFile() as messages:
        try:
            process = subprocess.Popen(
                [sys.executable, str(_PROGRAM)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=messages
            )
        except OSError as error:
            raise MeshError(f"unstructured_mesh: the process of Gmsh cannot be started ({error}).") from error
        output = b""
        with process:
            assert process.stdin is not None
            assert process.stdout is not None
            try:
                # Stdin stays open, since the process ends when it is closed.
                process.stdin.write(task)
                process.stdin.flush()
                output = process.stdout.read()
                status = process.wait()
            except BrokenPipeError:
                status = process.wait()
            finally:
                process.kill()
        messages.seek(0)
        return status, output, messages.read().decode("utf-8", "replace")
