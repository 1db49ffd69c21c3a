"""Export of a series by the suffix of the file."""

from pathlib import Path

from fedic._core import STRAIN_MEASURES
from fedic._internal.choices import check_choice
from fedic._internal.types import StrPath
from fedic.errors import FedicError, OptionError
from fedic.io.exports.arrays import write_mat, write_npz
from fedic.io.exports.fields import What, measured_frames
from fedic.io.exports.paraview import write_pvd
from fedic.io.exports.tables import write_csv, write_excel, write_parquet
from fedic.probes.series import Series
from fedic.results.strains import StrainMeasure

__all__ = ["export"]

_TABLES = {".csv": write_csv, ".parquet": write_parquet, ".xlsx": write_excel}
_SERIES = {".pvd": write_pvd, ".npz": write_npz, ".mat": write_mat}


def export(series: Series, path: StrPath, *, what: What = "nodes", measure: StrainMeasure = "green-lagrange") -> Path:
    """Write all frames of a series to a file, whole or not at all.

    ``.csv``, ``.parquet``, ``.xlsx``
        A long table, a row for each node or cell of each measured frame: ``frame``, ``time`` (seconds), ``node`` or
        ``cell`` (its label in the mesh file if the mesh has labels, else its index from 0), the reference position
        ``x``, ``y``; of nodes ``displacement_x``, ``..._y`` and ``displacement_std_x``, ``..._y`` (mesh's unit),
        ``displacement_u``, ``..._v`` (pixels) and the strains ``green_lagrange_strain_xx``, ``..._yy``, ``..._xy``; of
        cells the strains at the centres, their standard deviations ``green_lagrange_strain_std_xx``, ``residual`` and
        ``correlation``; ``valid`` and ``flags``, the names of the flags.
    ``.pvd``
        For ParaView: the times, and one ``.vtu`` file a measured frame beside it, as by `Result.write`.
    ``.npz``, ``.mat``
        The same arrays as those of `Result.write` with the frames along the first axis; frames that failed are NaN.
        Indices of nodes begin at 1 in ``.mat`` files. All frames are held in memory.

    Parameters
    ----------
    series : Series
        The frames.
    path : str or path
        The file to write; its suffix chooses the format.
    what : {"nodes", "cells"}
        Rows of long tables; the other formats hold both.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    OptionError
        If the suffix, `what` or the measure is unknown, or the series is too large for the format.
    FedicError
        If no frame was measured, a package is missing, or the file cannot be written.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    check_choice("what", what, ("nodes", "cells"))
    check_choice("measure", measure, STRAIN_MEASURES)
    if suffix not in _TABLES and suffix not in _SERIES:
        known = ", ".join([*_SERIES, *_TABLES])
        raise OptionError(f"{file}: a series cannot be exported as {file.suffix!r}; choose {known}.", "path")
    if not measured_frames(series):
        raise FedicError(f"{file}: no frame of the series was measured, so there is nothing to export.")
    if suffix in _TABLES:
        _TABLES[suffix](file, series, what, measure)
    else:
        _SERIES[suffix](file, series, measure)
    return file
