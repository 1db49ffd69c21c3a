"""Tables of a series: one row a frame."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fedic._core import STRAIN_MEASURES
from fedic._internal.choices import check_choice
from fedic._internal.optional import optional_module
from fedic.errors import OptionError
from fedic.probes.cell_points import StrainOptions
from fedic.probes.places import At, Place, places_of
from fedic.probes.quantities import QUANTITIES, checked_fields
from fedic.probes.readings import has_source, read
from fedic.probes.series import Series
from fedic.results.strains import StrainAxes, StrainMeasure

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["frame_table", "table"]


def table(
    series: Series,
    fields: str | Sequence[str],
    at: At = None,
    measure: StrainMeasure = "green-lagrange",
    axes: StrainAxes | None = None,
    centre: ArrayLike | None = None,
) -> "pd.DataFrame":
    """Read fields of all frames at some places.

    Parameters
    ----------
    series : Series
        The frames.
    fields : str or sequence of str
        Displacement: ``"x"``, ``"y"``, ``"magnitude"`` (mesh's unit), ``"u"``, ``"v"`` (pixels). Strains: ``"exx"``,
        ``"eyy"``, ``"exy"``, ``"e1"``, ``"e2"``, ``"von_mises"``. Extensometers: ``"strain"``, ``"elongation"``
        (mesh's unit), ``"rotation"`` (radians). Quality: ``"residual"`` (root mean square, grey levels),
        ``"correlation"``, ``"measured_share"`` (of the area, in valid cells).
    at : None, str, Gauge, sequence of them, or array_like of shape (m, 2)
        Where: the whole mesh (default); a set by its name; gauges; or points, in the mesh's unit. Over the mesh or a
        set, displacements are means over the nodes, and strains and quality means over the cells weighted by their
        areas. The mean is that of the part that was measured, and NaN if that is less than half of the place.
        ``magnitude``, ``e1``, ``e2`` and ``von_mises`` are those of the mean.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.
    axes, centre : optional
        Axes of the strains, as in `Result.strains`.

    Returns
    -------
    pandas.DataFrame
        Its index ``frame`` is the index of the frame. Columns ``time`` (seconds) and ``name``, then one per field and
        place with the standard deviation due to the noise of the images, ``eyy`` and ``eyy_std``; the quality has none.
        With several places the name of the gauge or set, or the number of the place, follows: ``eyy_0``,
        ``eyy_0_std``. NaN in frames that failed; deviations are NaN if the noise is not known, and for ``magnitude``,
        ``e1``, ``e2`` and ``von_mises`` where they have no derivative. ``attrs`` holds ``measure`` and ``unit``.

    Raises
    ------
    OptionError
        If a field, the measure or a set is unknown, no place has a field, or a place lies outside the mesh.
    FedicError
        If pandas is not installed.
    """
    pandas = optional_module("pandas", "tables", "tables of a series")
    names = checked_fields(fields)
    check_choice("measure", measure, STRAIN_MEASURES)
    options = StrainOptions(measure, axes, centre)
    series.mesh.strains(np.zeros((series.mesh.num_nodes, 2)), measure, axes=axes, centre=centre)  # checks the axes
    places = places_of(series.mesh, at)
    labels = [f"_{place.name or index}" if len(places) > 1 else "" for index, place in enumerate(places)]
    read_at = [[name for name in names if has_source(place, QUANTITIES[name].source)] for place in places]
    _check_each_is_read(names, places, read_at)
    has_deviations = any(QUANTITIES[name].source != "quality" for name in names)
    columns = [
        name + label + suffix
        for name in names
        for label, known in zip(labels, read_at, strict=True)
        if name in known
        for suffix in ([""] if QUANTITIES[name].source == "quality" else ["", "_std"])
    ]
    frames = list(series.frames)
    values = {column: np.full(len(frames), np.nan) for column in columns}
    for row, frame in enumerate(frames):
        if frame.error:
            continue
        result = series.result(frame.index)
        covariance = series.covariance(frame.index) if has_deviations else None
        for place, label, known in zip(places, labels, read_at, strict=True):
            for name, (value, deviation) in read(place, result, covariance, known, options).items():
                values[name + label][row] = value
                if name + label + "_std" in values:
                    values[name + label + "_std"][row] = deviation
    found: pd.DataFrame = pandas.DataFrame(
        {"time": [frame.time for frame in frames], "name": [frame.name for frame in frames], **values},
        index=pandas.Index([frame.index for frame in frames], name="frame", dtype="int64"),
    )
    found.attrs.update(measure=measure, unit=series.unit)
    return found


def frame_table(series: Series) -> "pd.DataFrame":
    """Return what is known of each frame, and its rigid motion.

    Parameters
    ----------
    series : Series
        The frames.

    Returns
    -------
    pandas.DataFrame
        Its index ``frame`` is the index of the frame. Columns ``time`` (seconds), ``name``, ``error`` (empty if
        measured), ``converged``, ``good``, ``residual_rms`` (grey levels), and the rigid motion of the measured nodes:
        ``rigid_x``, ``rigid_y``, the displacement of the mean of their positions in the mesh's unit, and
        ``rigid_rotation`` in radians, counter-clockwise. Numbers of frames that failed are NaN.

    Raises
    ------
    FedicError
        If pandas is not installed.
    """
    pandas = optional_module("pandas", "tables", "tables of a series")
    frames = list(series.frames)
    motions = np.full((len(frames), 3), np.nan)
    for row, frame in enumerate(frames):
        if not frame.error:
            motion = series.result(frame.index).rigid_motion()
            motions[row] = *motion.translation, motion.rotation
    columns = {
        name: [getattr(frame, name) for frame in frames]
        for name in ("time", "name", "error", "converged", "good", "residual_rms")
    }
    rigid = dict(zip(("rigid_x", "rigid_y", "rigid_rotation"), motions.T, strict=True))
    index = pandas.Index([frame.index for frame in frames], name="frame", dtype="int64")
    found: pd.DataFrame = pandas.DataFrame({**columns, **rigid}, index=index)
    return found


def _check_each_is_read(names: list[str], places: list[Place], read_at: list[list[str]]) -> None:
    for name in names:
        if any(name in known for known in read_at):
            continue
        source = QUANTITIES[name].source
        if source == "ends":
            reason = "only extensometers have it; give at=fedic.Gauge.extensometer(a, b)"
        elif all(place.ends is not None for place in places):
            own = ", ".join(each for each, quantity in QUANTITIES.items() if quantity.source in ("ends", "quality"))
            reason = f"extensometers have {own} only; give points or a gauge with an area"
        else:
            reason = "the set has no cells; give a gauge or a set of cells"
        raise OptionError(f"fields has {name!r}, which cannot be read here: {reason}.", "fields")
