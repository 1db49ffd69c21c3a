"""Long tables of a series: ``.csv``, ``.parquet`` and ``.xlsx``."""

from pathlib import Path
from typing import Any

import numpy as np

from fedic._internal.optional import optional_module
from fedic.errors import OptionError
from fedic.io.atomic import atomic_path
from fedic.io.exports.fields import What, columns_of_frames, measured_frames
from fedic.probes.series import Series
from fedic.results.strains import StrainMeasure

__all__ = ["EXCEL_ROWS", "write_csv", "write_excel", "write_parquet"]

EXCEL_ROWS = 1_048_576
"""Largest number of rows of a sheet of Excel, with the heading."""
_GROUP_ROWS = 100_000
"""Rows of a group of a parquet file, which are held in memory; more if a frame has more."""


def write_csv(path: Path, series: Series, what: What, measure: StrainMeasure) -> None:
    """Write a long table as text with commas, one frame after the other; NaN is an empty field.

    Parameters
    ----------
    path : Path
        The file.
    series : Series
        The frames.
    what : {"nodes", "cells"}
        Whether a row is a node or a cell.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.
    """
    pandas = optional_module("pandas", "tables", f"the export {path.name}")
    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        for number, columns in enumerate(columns_of_frames(series, what, measure)):
            pandas.DataFrame(columns).to_csv(file, index=False, header=number == 0, lineterminator="\n")


def write_parquet(path: Path, series: Series, what: What, measure: StrainMeasure) -> None:
    """Write a long table as Apache Parquet, in groups of whole frames.

    Parameters
    ----------
    path : Path
        The file.
    series : Series
        The frames.
    what : {"nodes", "cells"}
        Whether a row is a node or a cell.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure; metadata ``fedic.strain_measure`` of the schema, beside ``fedic.unit``.
    """
    pyarrow = optional_module("pyarrow", "tables", f"the export {path.name}")
    parquet = optional_module("pyarrow.parquet", "tables", f"the export {path.name}")
    metadata = {"fedic.strain_measure": measure, "fedic.unit": series.unit}
    with atomic_path(path) as temporary:
        writer, waiting = None, []
        try:
            for columns in columns_of_frames(series, what, measure):
                waiting.append(pyarrow.table(columns))
                if writer is None:
                    schema = waiting[0].schema.with_metadata(metadata)
                    writer = parquet.ParquetWriter(temporary, schema)
                if sum(len(table) for table in waiting) >= _GROUP_ROWS:
                    _write_group(writer, pyarrow.concat_tables(waiting))
                    waiting = []
            if writer is not None and waiting:
                _write_group(writer, pyarrow.concat_tables(waiting))
        finally:
            if writer is not None:
                writer.close()


def write_excel(path: Path, series: Series, what: What, measure: StrainMeasure) -> None:
    """Write a long table as a sheet of Excel; NaN is an empty cell.

    Parameters
    ----------
    path : Path
        The file.
    series : Series
        The frames.
    what : {"nodes", "cells"}
        Whether a row is a node or a cell.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.

    Raises
    ------
    OptionError
        If the table has more rows than a sheet.
    """
    openpyxl = optional_module("openpyxl", "tables", f"the export {path.name}")
    count = series.mesh.num_nodes if what == "nodes" else series.mesh.num_cells
    rows = count * len(measured_frames(series)) + 1
    if rows > EXCEL_ROWS:
        raise OptionError(
            f"{path}: the table has {rows:,} rows, and a sheet of Excel at most {EXCEL_ROWS:,}; export it as .parquet "
            "or .csv.",
            "path",
        )
    book = openpyxl.Workbook(write_only=True)
    sheet = book.create_sheet(what)
    try:
        for number, columns in enumerate(columns_of_frames(series, what, measure)):
            if number == 0:
                sheet.append(list(columns))
            for row in zip(*(_cells(values) for values in columns.values()), strict=True):
                sheet.append(row)
    finally:
        sheet.close()
    with atomic_path(path) as temporary:
        book.save(temporary)


def _write_group(writer: Any, table: Any) -> None:
    writer.write_table(table.cast(writer.schema), row_group_size=len(table))


def _cells(values: Any) -> list[Any]:
    if values.dtype.kind != "f":
        return list(values.tolist())
    return [value if known else None for value, known in zip(values.tolist(), np.isfinite(values), strict=True)]
