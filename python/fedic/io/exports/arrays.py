"""All frames of a series in arrays: ``.npz`` and ``.mat``."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._internal.labels import cell_labels, node_labels
from fedic._internal.optional import optional_module
from fedic.errors import OptionError
from fedic.io.atomic import atomic_path
from fedic.io.exports.fields import cell_arrays, node_arrays
from fedic.probes.series import Series
from fedic.results.strains import StrainMeasure

__all__ = ["write_mat", "write_npz"]

_MATLAB_BYTES = 2**31 - 1
"""Largest array of a file of MATLAB, version 5."""


def write_npz(path: Path, series: Series, measure: StrainMeasure) -> None:
    """Write all frames as arrays of NumPy.

    Parameters
    ----------
    path : Path
        The file.
    series : Series
        The frames.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.
    """
    arrays = _arrays(series, measure)
    with atomic_path(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]


def write_mat(path: Path, series: Series, measure: StrainMeasure) -> None:
    """Write all frames as arrays of MATLAB, whose indices of nodes begin at 1.

    Parameters
    ----------
    path : Path
        The file.
    series : Series
        The frames.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.

    Raises
    ------
    OptionError
        If an array is larger than the format allows.
    """
    savemat = optional_module("scipy.io", "matlab", f"the export {path.name}").savemat
    components = max(2 * series.mesh.num_nodes, 3 * series.mesh.num_nodes, 3 * series.mesh.num_cells)
    size = 8 * components * len(series.frames)
    if size > _MATLAB_BYTES:
        raise OptionError(
            f"{path}: the largest array takes {size / 2**30:.1f} GiB, and .mat files hold 2 GiB at most; export the "
            "series as .npz or .parquet.",
            "path",
        )
    arrays = {name: _for_matlab(name, values) for name, values in _arrays(series, measure).items()}
    with atomic_path(path) as temporary, temporary.open("wb") as file:
        savemat(file, arrays, do_compression=True, oned_as="column")


def _arrays(series: Series, measure: StrainMeasure) -> dict[str, NDArray[Any]]:
    mesh, frames = series.mesh, list(series.frames)
    found: dict[str, NDArray[Any]] = {
        "frame": np.array([frame.index for frame in frames], dtype=np.int64),
        "time": np.array([frame.time for frame in frames], dtype=np.float64),
        "name": np.array([frame.name for frame in frames], dtype=np.str_),
        "error": np.array([frame.error for frame in frames], dtype=np.str_),
        "points": mesh.points,
        **{f"cells_{name}": nodes for name, nodes in mesh.cells.items()},
        "node_labels": node_labels(mesh),
        "cell_labels": cell_labels(mesh),
        "strain_measure": np.array(measure),
        "unit": np.array(series.unit),
    }
    for row, frame in enumerate(frames):
        if frame.error:
            continue
        result, covariance = series.result(frame.index), series.covariance(frame.index)
        arrays = {**node_arrays(result, covariance, measure), **cell_arrays(result, covariance, measure)}
        for name, values in arrays.items():
            if name not in found:
                empty = np.nan if values.dtype.kind == "f" else 0
                found[name] = np.full((len(frames), *values.shape), empty, dtype=values.dtype)
            found[name][row] = values
    return found


def _for_matlab(name: str, values: NDArray[Any]) -> Any:
    if name.startswith("cells_"):
        return values + 1
    if values.dtype.kind == "U":
        return values.astype(object) if values.ndim else str(values)
    return values
