"""The table of all rows of a comparison."""

from typing import Any

from rich import box
from rich.table import Table

_COLUMNS = (
    "Mpx",
    "threads",
    "package",
    "px",
    "dofs",
    "seconds",
    "/ fedic",
    "frame s",
    "outside",
    "ns",
    "/ stream",
    "peak MB",
    "B/px",
    "error",
)
_LEGEND = """\
seconds, peak MB, B/px: whole process, from files to written result. / fedic: over the seconds of fedic, else alike.
px: size of elements, or step of subsets. dofs: unknowns. frame s: next frame of a series, from file to stored result.
outside: part of the frame outside its iterations. ns: per point and iteration. / stream: over the ns of a plain loop
over the same bytes, alike. error: root mean square, in pixels."""


def table(rows: list[dict[str, Any]]) -> Table:
    """Lay the rows out, sizes apart."""
    shown = Table(title="Pairs of images", box=box.SIMPLE_HEAD, show_edge=False, padding=(0, 0, 0, 1))
    for heading in _COLUMNS:
        shown.add_column(heading, justify="left" if heading == "package" else "right", no_wrap=True)
    for index, row in enumerate(rows):
        where = [f"{row['megapixels']:g}", str(row["threads"]), row["package"], str(row["element_px"])]
        missing = next((word for word in ("failed", "absent") if word in row), None)
        shown.add_row(*where, *([missing] if missing else _values(row, rows)))
        if index + 1 < len(rows) and rows[index + 1]["megapixels"] != row["megapixels"]:
            shown.add_section()
    return shown


def legend(rows: list[dict[str, Any]]) -> str:
    """Say what the columns are, which versions were measured, what failed and what is not installed."""
    versions = {row["package"].split()[0]: row["version"] for row in rows if row.get("version")}
    absent = {f"{row['package']}: {row['absent']}": None for row in rows if "absent" in row}
    failed = [
        f"{row['package']}, {row['megapixels']:g} Mpx, threads: {row['threads']}: {row['failed']}"
        for row in rows
        if "failed" in row
    ]
    measured = ", ".join(f"{name} {version}" for name, version in versions.items())
    return "\n".join((_LEGEND, *([f"versions: {measured}"] if measured else []), *absent, *failed))


def nanoseconds(row: dict[str, Any]) -> float | None:
    """Return the time per point and iteration of a row that has one."""
    said = row.get("said", {})
    iteration = row.get("series", said).get("iteration")
    return None if iteration is None else iteration / said["points"] * 1e9


def alike(rows: list[dict[str, Any]], row: dict[str, Any], package: str) -> dict[str, Any]:
    """Return the row of another package for the same images and threads and the common elements, empty if none."""
    keys = ("megapixels", "threads")
    return next((one for one in rows if one["package"] == package and all(one[key] == row[key] for key in keys)), {})


def _values(row: dict[str, Any], rows: list[dict[str, Any]]) -> list[str]:
    pixels = row["width"] * row["height"]
    fedic, stream = alike(rows, row, "fedic").get("seconds"), nanoseconds(alike(rows, row, "stream"))
    seconds, each, peak = row.get("seconds"), nanoseconds(row), row.get("peak_MB")
    series = row.get("series")
    return [
        _text(row["said"].get("unknowns"), ".0f"),
        _text(seconds, ".2f"),
        _figures(seconds / fedic if seconds and fedic else None),
        _text(series and series["frame"], ".3f"),
        _text(series and series["outside"] / series["frame"], ".0%"),
        _figures(each),
        _figures(each / stream if each and stream else None),
        _text(peak, ".0f"),
        _text(peak and peak * 1e6 / pixels, ".1f"),
        _text(row.get("error_rms"), ".4f"),
    ]


def _text(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def _figures(value: float | None) -> str:
    """Write three figures, more where there are more before the point."""
    return _text(value, ".0f" if value is not None and value >= 100.0 else "#.3g")
