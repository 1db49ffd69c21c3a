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
_CAPTION = """\
seconds, peak MB, B/px: whole process, from files to written result. / fedic: over the seconds of fedic, else alike.
px: elements, or step of subsets; dofs: unknowns. frame s: next frame of a series, file to stored result; outside: of its iterations.
ns: per point and iteration; / stream: over that of a plain loop over the same bytes. error: rms, in px."""


def table(rows: list[dict[str, Any]]) -> Table:
    """Lay the rows out, sizes apart, and say below what failed and which versions were measured."""
    shown = Table(title="Pairs of images", box=box.SIMPLE_HEAD, show_edge=False, padding=(0, 0, 0, 1))
    for heading in _COLUMNS:
        shown.add_column(heading, justify="left" if heading == "package" else "right", no_wrap=True)
    failures: list[str] = []
    for index, row in enumerate(rows):
        where = [f"{row['megapixels']:g}", str(row["threads"]), row["package"], str(row["element_px"])]
        if problem := row.get("failed") or row.get("absent"):
            failures.append(f"{row['package']}, {row['megapixels']:g} Mpx, threads: {row['threads']}: {problem}")
            shown.add_row(*where, "failed" if "failed" in row else "absent")
        else:
            shown.add_row(*where, *_values(row, rows))
        if index + 1 < len(rows) and rows[index + 1]["megapixels"] != row["megapixels"]:
            shown.add_section()
    versions = {row["package"].split()[0]: row["version"] for row in rows if row.get("version")}
    measured = ", ".join(f"{name} {version}" for name, version in versions.items())
    shown.caption = "\n".join((_CAPTION, *([f"Versions: {measured}."] if measured else []), *failures))
    shown.caption_justify = "left"
    return shown


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
        _text(seconds / fedic if seconds and fedic else None, ".3g"),
        _text(series and series["frame"], ".3f"),
        _text(series and series["outside"] / series["frame"], ".0%"),
        _text(each, ".3g"),
        _text(each / stream if each and stream else None, ".3g"),
        _text(peak, ".0f"),
        _text(peak and peak * 1e6 / pixels, ".1f"),
        _text(row.get("error_rms"), ".4f"),
    ]


def _text(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)
