"""The data of one frame: from a result to the arrays of the file, and back."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.measurement import Measurement
from fedic._internal.types import Camera, Floats
from fedic.campaign.frames.entry import entry_files
from fedic.campaign.frames.series import SeriesFrame
from fedic.campaign.store.layout import (
    COLUMNS,
    HISTORY_ROWS,
    REPEATS,
    Field,
    fields,
)
from fedic.results import Attempt, Iteration, Quality, Result, StrainMeasure
from fedic.results.strains import strain_fields

__all__ = ["FrameData", "of_failed_frame", "of_result", "to_result"]

Arrays = Mapping[str, NDArray[Any]]
_BYTES = {column.name: np.dtype(column.dtype).itemsize for column in COLUMNS}


@dataclass(frozen=True, eq=False)
class FrameData:
    """What is stored of one frame.

    Attributes
    ----------
    index : int
        Its number.
    fields : mapping of str to ndarray
        Fields by the names ``"PointData/..."`` and ``"CellData/..."``.
    unchecked : ndarray of float64, shape (n, 2)
        Displacement as the iterations left it.
    information : ndarray of float64, shape (num_cells, 2)
        Factors of the cells on the Hessian and on the noise; one where there are none.
    columns : mapping of str to object
        Values by the names of `COLUMNS`.
    """

    index: int
    fields: Arrays
    unchecked: Floats
    information: Floats
    columns: Mapping[str, Any]


def of_result(
    frame: SeriesFrame, result: Result, measure: StrainMeasure, reference: int, drift: Floats | None, *, has_drift: bool
) -> FrameData:
    """Return the data of a frame that was measured.

    Parameters
    ----------
    frame : SeriesFrame
        The frame.
    result : Result
        Its result.
    measure : {"green-lagrange", "hencky", "small"}
        Measure of the strains.
    reference : int
        Number of the frame that was the reference image; -1 for the first reference image.
    drift : ndarray of float64, shape (n, 2), or None
        Displacement through later reference images minus the direct one.
    has_drift : bool
        Whether the file has a field for it.

    Returns
    -------
    FrameData
        The data.
    """
    mesh, quality = result.mesh, result.quality
    deviations, strain_deviations = result._deviations(measure)
    strains = result.strains(measure).components
    outside = np.zeros(mesh.num_cells, dtype=np.uint8)
    outside[result.outside_cells] = 1
    arrays: dict[str, NDArray[Any]] = {
        "PointData/displacement": _in_space(result.displacement),
        "PointData/displacement_px": _in_space(result.pixel_displacement),
        "PointData/standard_deviation": _in_space(deviations),
        "PointData/standard_deviation_px": quality.standard_deviation,
        "PointData/conditioning": quality.conditioning,
        "PointData/flags": quality.node_flags,
        "CellData/residual": result.cell_residuals,
        "CellData/correlation": quality.correlation,
        "CellData/used_share": quality.used_share,
        "CellData/kept_share": quality.kept_share,
        "CellData/normalized_residual": quality.normalized_residual,
        "CellData/misfit": quality.misfit,
        "CellData/outside": outside,
        "CellData/flags": quality.cell_flags,
    }
    for deviation, values in ((False, strains), (True, strain_deviations)):
        names = strain_fields(measure, deviation=deviation)
        arrays.update((f"CellData/{name}", column) for name, column in zip(names, values.T, strict=True))
    if has_drift:
        arrays["PointData/drift"] = _in_space(np.full((mesh.num_nodes, 2), np.nan) if drift is None else drift)
    checksum = 0 if result._measurement is None else result._measurement.deformed.checksum
    columns = {
        **_empty_columns(frame),
        "converged": result.converged,
        "good": quality.is_good,
        "residual_rms": result.residual_rms,
        "error_left": result.error_left,
        "noise": quality.noise,
        "iterations": result.iterations,
        "num_points": result.num_points,
        "reference": reference,
        "start": result.start.encode(),
        "has_information": result.information is not None,
        "has_weights": result.information is not None and len(result.information[1]) > 0,
        "saturated_share": quality.saturated_share,
        "repeats": _rows(quality.repeats, REPEATS),
        "attempts": json.dumps([[*attempt[:5], attempt.error[:200]] for attempt in result.attempts]).encode(),
        "history": _rows(np.array(result.history, dtype=np.float64).reshape(-1, 4)[-HISTORY_ROWS:], HISTORY_ROWS),
        "checksum": checksum,
    }
    information = np.ones((mesh.num_cells, 2)) if result.information is None else result.information[0]
    return FrameData(frame.index, arrays, result.unchecked_displacement, information, columns)


def of_failed_frame(
    frame: SeriesFrame, error: str, mesh: Mesh, measure: StrainMeasure, *, has_drift: bool
) -> FrameData:
    """Return the data of a frame that could not be measured: NaN, no flags, and the reason."""

    def nothing(field: Field) -> NDArray[Any]:
        shape = (field.rows(mesh), field.components) if field.components > 1 else (field.rows(mesh),)
        return np.full(shape, 0 if field.dtype == "u1" else np.nan)

    arrays = {f"{field.group}/{field.name}": nothing(field) for field in fields(measure, drift=has_drift)}
    columns = {**_empty_columns(frame), "error": _shortened("error", error)}
    unchecked, information = (np.full((count, 2), np.nan) for count in (mesh.num_nodes, mesh.num_cells))
    return FrameData(frame.index, arrays, unchecked, information, columns)


def to_result(mesh: Mesh, camera: Camera, unit: str, data: FrameData, measurement: Measurement | None) -> Result:
    """Return the result of a frame.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    unit : str
        Unit of length of the mesh.
    data : FrameData
        The data of a frame that was measured.
    measurement : Measurement or None
        Its images and options.

    Returns
    -------
    Result
        The result, without robust weights of points.
    """
    arrays, columns = data.fields, data.columns
    repeats = np.asarray(columns["repeats"], dtype=np.float64)
    history = np.asarray(columns["history"], dtype=np.float64)
    history = history[np.isfinite(history[:, 0])]

    def field(name: str) -> Floats:
        return np.asarray(arrays[name], dtype=np.float64)

    return Result(
        mesh=mesh,
        camera=camera,
        displacement=field("PointData/displacement")[:, :2],
        pixel_displacement=field("PointData/displacement_px")[:, :2],
        converged=bool(columns["converged"]),
        error_left=float(columns["error_left"]),
        iterations=int(columns["iterations"]),
        history=[Iteration(int(level), int(number), *rest) for level, number, *rest in history.tolist()],
        num_points=int(columns["num_points"]),
        residual_rms=float(columns["residual_rms"]),
        cell_residuals=field("CellData/residual"),
        outside_cells=np.flatnonzero(arrays["CellData/outside"]),
        unchecked_displacement=data.unchecked,
        quality=Quality(
            noise=float(columns["noise"]),
            used_share=field("CellData/used_share"),
            kept_share=field("CellData/kept_share"),
            correlation=field("CellData/correlation"),
            normalized_residual=field("CellData/normalized_residual"),
            misfit=field("CellData/misfit"),
            standard_deviation=field("PointData/standard_deviation_px"),
            conditioning=field("PointData/conditioning"),
            repeats=repeats[np.isfinite(repeats).all(axis=1)],
            saturated_share=(float(columns["saturated_share"][0]), float(columns["saturated_share"][1])),
            converged=bool(columns["converged"]),
            cell_flags=np.asarray(arrays["CellData/flags"], dtype=np.uint8),
            node_flags=np.asarray(arrays["PointData/flags"], dtype=np.uint8),
        ),
        start=columns["start"].decode(),
        information=(data.information, [], []) if columns["has_information"] and not columns["has_weights"] else None,
        attempts=tuple(Attempt(*entry) for entry in json.loads(columns["attempts"] or b"[]")),
        unit=unit,
        _measurement=measurement,
    )


def _empty_columns(frame: SeriesFrame) -> dict[str, Any]:
    """Return the columns of a frame without a result."""
    empty: dict[str, Any] = {
        column.name: np.full(column.shape, np.nan)
        if column.dtype == "f8"
        else (b"" if column.dtype.startswith("S") else 0)
        for column in COLUMNS
    }
    files = "\n".join(str(file.absolute()) for file in entry_files(frame.entry))
    names = files.encode("utf-8", "surrogateescape")
    return empty | {
        "name": _shortened("name", frame.name),
        # A part of a name would be that of another file.
        "image": names if len(names) <= _BYTES["image"] else b"",
        "time": frame.time,
        "reference": -1,
    }


def _shortened(column: str, text: str) -> bytes:
    """Return a text in UTF-8 of at most the bytes of a column."""
    return text.encode("utf-8", "replace")[: _BYTES[column]].decode("utf-8", "ignore").encode()


def _rows(values: Floats, count: int) -> Floats:
    """Return the first rows, filled up by NaN."""
    rows = np.full((count, values.shape[1]), np.nan)
    rows[: len(values)] = values[:count]
    return rows


def _in_space(vectors: Floats) -> Floats:
    """Return plane vectors with a third component: zero, or NaN where they are not known."""
    return np.column_stack([vectors, np.where(np.isfinite(vectors).all(axis=1), 0.0, np.nan)])
