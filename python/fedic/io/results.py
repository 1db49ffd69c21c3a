"""The file formats of a result."""

import contextlib
import io
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fedic._core import __version__
from fedic._internal.types import Floats
from fedic.errors import FedicError
from fedic.io._vtu import write_vtu
from fedic.io.atomic import replacing, write_json
from fedic.result import Result

__all__ = ["summary", "write_result"]


def write_result(result: Result, path: Path) -> Path:
    """Write a result in the format its suffix names.

    Parameters
    ----------
    result : Result
        What to write.
    path : Path
        Ends in ``.vtu``, ``.vtk``, ``.npz`` or ``.json``.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    FedicError
        If the suffix is another, or the file cannot be written.
    """
    writers: dict[str, Callable[[Result, Path], None]] = {
        ".vtu": _write_vtu,
        ".vtk": _write_vtk,
        ".npz": _write_arrays,
        ".json": _write_summary,
    }
    writer = writers.get(path.suffix.lower())
    if writer is None:
        raise FedicError(f"{path}: a result cannot be written as {path.suffix!r}; choose {', '.join(writers)}.")
    writer(result, path)
    return path


def summary(result: Result) -> dict[str, Any]:
    """Return what a result says beside its fields, as JSON types.

    Parameters
    ----------
    result : Result
        What to sum up.

    Returns
    -------
    dict
        Numbers of nodes, cells and points, convergence and residual; a number that is not finite is None.
    """
    return {
        "converged": result.converged,
        "iterations": result.iterations,
        "residual_rms": _finite(result.residual_rms),
        "num_nodes": result.mesh.num_nodes,
        "num_cells": result.mesh.num_cells,
        "num_points": result.num_points,
        "outside_cells": result.outside_cells.tolist(),
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _write_summary(result: Result, path: Path) -> None:
    history = [
        {
            "level": entry.level,
            "iteration": entry.iteration,
            "correction": _finite(entry.correction),
            "residual_rms": _finite(entry.residual_rms),
        }
        for entry in result.history
    ]
    write_json(path, {"fedic": __version__, **summary(result), "history": history})


def _write_arrays(result: Result, path: Path) -> None:
    arrays = {
        "points": result.mesh.points,
        **{f"cells_{name}": nodes for name, nodes in result.mesh.cells.items()},
        "displacement": result.displacement,
        "pixel_displacement": result.pixel_displacement,
        "strains": result.strains(),
        "cell_residuals": result.cell_residuals,
        "outside_cells": result.outside_cells,
        "history": np.array(result.history, dtype=np.float64).reshape(-1, 4),
        "converged": np.array(result.converged),
        "iterations": np.array(result.iterations),
        "num_points": np.array(result.num_points),
        "residual_rms": np.array(result.residual_rms),
    }
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]


def _write_vtu(result: Result, path: Path) -> None:
    point_data, cell_data = _fields(result)
    with replacing(path) as temporary:
        write_vtu(temporary, _three_components(result.mesh.points), result.mesh.cells, point_data, cell_data)


def _write_vtk(result: Result, path: Path) -> None:
    import meshio

    blocks = list(result.mesh.cells.items())
    splits = np.cumsum([len(nodes) for _, nodes in blocks])[:-1]
    point_data, cell_data = _fields(result)
    content = meshio.Mesh(
        _three_components(result.mesh.points),
        blocks,
        point_data=point_data,
        cell_data={name: np.split(np.ascontiguousarray(values), splits) for name, values in cell_data.items()},
    )
    with replacing(path) as temporary, contextlib.redirect_stderr(io.StringIO()):
        meshio.write(temporary, content, file_format="vtk", binary=True)


def _fields(result: Result) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Return what a mesh file says of the nodes and of the cells."""
    exx, eyy, exy = result.strains().T
    point_data = {
        "displacement": _three_components(result.displacement),
        "displacement_px": _three_components(result.pixel_displacement),
    }
    return point_data, {"strain_xx": exx, "strain_yy": eyy, "strain_xy": exy, "residual": result.cell_residuals}


def _three_components(vectors: Floats) -> Floats:
    missing = 3 - vectors.shape[1]
    return np.ascontiguousarray(np.pad(vectors, ((0, 0), (0, missing))))
