"""Files of results: ``.vtu``, ``.vtk``, ``.npz`` and ``.json``."""

import contextlib
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh, __version__
from fedic._internal.types import Floats
from fedic.errors import OptionError
from fedic.io.atomic import atomic_path, write_json
from fedic.results.strains import strain_fields

__all__ = ["write_result"]


def write_result(path: Path, mesh: Mesh, arrays: Mapping[str, NDArray[Any]], summary: Mapping[str, Any]) -> Path:
    """Write a result in the format that the suffix names.

    Parameters
    ----------
    path : Path
        Ends in ``.vtu``, ``.vtk``, ``.npz`` or ``.json``.
    mesh : Mesh
        The mesh.
    arrays : mapping of str to ndarray
        The arrays of an ``.npz`` file. The mesh formats take those of the nodes and of the cells from it, and name the
        strains by ``strain_measure``.
    summary : mapping
        The content of a ``.json`` file.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    OptionError
        If the suffix is unknown.
    FedicError
        If the file cannot be written.
    """
    suffix = path.suffix.lower()
    if suffix == ".json":
        write_json(path, {"fedic": __version__, **summary})
    elif suffix == ".npz":
        with atomic_path(path) as temporary, temporary.open("wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]
    elif suffix == ".vtu":
        from fedic.io.mesh_formats.vtk import write_vtu  # not needed by `import fedic`

        with atomic_path(path) as temporary:
            write_vtu(
                temporary,
                _three_components(mesh.points),
                mesh.cells,
                _point_data(arrays),
                _cell_data(arrays),
                {name: np.array([arrays[name]], dtype=np.uint8) for name in ("converged", "good")},
                {"displacement": str(arrays["unit"])} if str(arrays["unit"]) else {},
            )
    elif suffix == ".vtk":
        _write_vtk(path, mesh, arrays)
    else:
        raise OptionError(
            f"{path}: a result cannot be written as {path.suffix!r}; choose .vtu, .vtk, .npz, .json.", "path"
        )
    return path


def _write_vtk(path: Path, mesh: Mesh, arrays: Mapping[str, NDArray[Any]]) -> None:
    import meshio

    blocks = list(mesh.cells.items())
    splits = np.cumsum([len(nodes) for _, nodes in blocks])[:-1]
    content = meshio.Mesh(
        _three_components(mesh.points),
        blocks,
        point_data=_point_data(arrays),
        cell_data={name: np.split(np.ascontiguousarray(values), splits) for name, values in _cell_data(arrays).items()},
    )
    with atomic_path(path) as temporary, contextlib.redirect_stderr(io.StringIO()):
        meshio.write(temporary, content, file_format="vtk", binary=True)


def _point_data(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    return {
        "displacement": _three_components(arrays["displacement"]),
        "standard_deviation": _three_components(arrays["standard_deviations"]),
        "displacement_px": _three_components(arrays["pixel_displacement"]),
        "standard_deviation_px": arrays["node_standard_deviation_px"],
        "flags": arrays["node_flags"],
    }


def _cell_data(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    measure: Any = str(arrays["strain_measure"])
    return {
        **dict(zip(strain_fields(measure), arrays["strains"].T, strict=True)),
        **dict(zip(strain_fields(measure, deviation=True), arrays["strain_standard_deviations"].T, strict=True)),
        "residual": arrays["cell_residuals"],
        "correlation": arrays["cell_correlation"],
        "flags": arrays["cell_flags"],
    }


def _three_components(vectors: Floats) -> Floats:
    missing = 3 - vectors.shape[1]
    return np.ascontiguousarray(np.pad(vectors, ((0, 0), (0, missing))))
