"""Fields of the frames of a series, as arrays and as columns of long tables."""

from collections.abc import Iterator, Mapping
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_FLAGS, NODE_FLAGS, Mesh
from fedic._internal.labels import cell_labels, node_labels
from fedic._internal.types import Floats
from fedic.probes.series import FrameInfo, Series
from fedic.results.covariance import Covariance
from fedic.results.result import Result
from fedic.results.strains import StrainMeasure, strain_fields

__all__ = ["What", "cell_arrays", "columns_of_frames", "measured_frames", "node_arrays"]

What = Literal["nodes", "cells"]


def measured_frames(series: Series) -> list[FrameInfo]:
    """Return the frames that were measured.

    Parameters
    ----------
    series : Series
        The frames.

    Returns
    -------
    list of FrameInfo
        Those without an error.
    """
    return [frame for frame in series.frames if not frame.error]


def node_arrays(result: Result, covariance: Covariance | None, measure: StrainMeasure) -> dict[str, NDArray[Any]]:
    """Return the fields of the nodes.

    Parameters
    ----------
    result : Result
        The result.
    covariance : Covariance or None
        The covariance of its displacement.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.

    Returns
    -------
    dict of str to ndarray, shapes (n,) and (n, k)
        ``displacement`` and ``standard_deviations`` in the mesh's unit, ``pixel_displacement``, ``node_strains``,
        ``valid_nodes`` and ``node_flags``.
    """
    unknown = np.full(result.displacement.shape, np.nan)
    return {
        "displacement": result.displacement,
        "standard_deviations": unknown if covariance is None else covariance.standard_deviations,
        "pixel_displacement": result.pixel_displacement,
        "node_strains": result.strains(measure, at="nodes").components,
        "valid_nodes": result.valid_nodes,
        "node_flags": result.quality.node_flags,
    }


def cell_arrays(result: Result, covariance: Covariance | None, measure: StrainMeasure) -> dict[str, NDArray[Any]]:
    """Return the fields of the cells.

    Parameters
    ----------
    result : Result
        The result.
    covariance : Covariance or None
        The covariance of its displacement.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.

    Returns
    -------
    dict of str to ndarray, shapes (num_cells,) and (num_cells, 3)
        ``strains`` and ``strain_standard_deviations``, ``cell_residuals``, ``cell_correlation``, ``valid_cells`` and
        ``cell_flags``.
    """
    unknown = np.full((result.mesh.num_cells, 3), np.nan)
    return {
        "strains": result.strains(measure).components,
        "strain_standard_deviations": unknown if covariance is None else covariance.strain_deviations(measure),
        "cell_residuals": result.cell_residuals,
        "cell_correlation": result.quality.correlation,
        "valid_cells": result.valid_cells,
        "cell_flags": result.quality.cell_flags,
    }


class _Layout(NamedTuple):
    """Columns of a long table: of each array one name, or one a component."""

    label: str
    flags: Mapping[str, str]
    columns: Mapping[str, tuple[str, ...]]


def columns_of_frames(series: Series, what: What, measure: StrainMeasure) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the columns of the long table of each measured frame.

    Parameters
    ----------
    series : Series
        The frames.
    what : {"nodes", "cells"}
        Whether a row is a node or a cell.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.

    Yields
    ------
    dict of str to ndarray, shape (n,) or (num_cells,)
        ``frame``, ``time``, ``node`` or ``cell`` (the label), the position, and the fields. ``flags`` is text: the
        names of the flags, separated by blanks.
    """
    mesh = series.mesh
    layout = _node_layout(measure) if what == "nodes" else _cell_layout(measure)
    labels = node_labels(mesh) if what == "nodes" else cell_labels(mesh)
    positions = mesh.points if what == "nodes" else _centres(mesh)
    place = dict(zip("xyz", positions.T, strict=False))
    for frame in measured_frames(series):
        result, covariance = series.result(frame.index), series.covariance(frame.index)
        arrays = (node_arrays if what == "nodes" else cell_arrays)(result, covariance, measure)
        columns: dict[str, NDArray[Any]] = {}
        for array, names in layout.columns.items():
            parts = arrays[array].reshape(len(labels), -1).T
            columns.update(zip(names, parts, strict=True))
        columns["flags"] = _named(columns["flags"], layout.flags)
        yield {
            "frame": np.full(len(labels), frame.index, dtype=np.int64),
            "time": np.full(len(labels), frame.time, dtype=np.float64),
            layout.label: labels,
            **place,
            **columns,
        }


def _node_layout(measure: StrainMeasure) -> _Layout:
    return _Layout(
        "node",
        NODE_FLAGS,
        {
            "displacement": ("displacement_x", "displacement_y"),
            "standard_deviations": ("displacement_std_x", "displacement_std_y"),
            "pixel_displacement": ("displacement_u", "displacement_v"),
            "node_strains": strain_fields(measure),
            "valid_nodes": ("valid",),
            "node_flags": ("flags",),
        },
    )


def _cell_layout(measure: StrainMeasure) -> _Layout:
    return _Layout(
        "cell",
        CELL_FLAGS,
        {
            "strains": strain_fields(measure),
            "strain_standard_deviations": strain_fields(measure, deviation=True),
            "cell_residuals": ("residual",),
            "cell_correlation": ("correlation",),
            "valid_cells": ("valid",),
            "cell_flags": ("flags",),
        },
    )


def _centres(mesh: Mesh) -> Floats:
    return mesh.strains(np.zeros((mesh.num_nodes, 2))).positions


def _named(bits: NDArray[Any], flags: Mapping[str, str]) -> NDArray[Any]:
    """Return the names of the flags that are set in each element."""
    kinds, place = np.unique(bits, return_inverse=True)
    names = [" ".join(name for k, name in enumerate(flags) if int(kind) >> k & 1) for kind in kinds]
    return np.array(names, dtype=object)[place]
