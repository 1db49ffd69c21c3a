"""Tables of an assessment, as text and in files."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from fedic._core import __version__
from fedic.assess.assessment import LIMITS, Assessment
from fedic.errors import OptionError
from fedic.io.atomic import atomic_path, write_json

__all__ = ["Table", "markdown", "notes", "tables", "write_assessment"]

_TITLE = "Assessment after EN 4861 and VDI/VDE 2626 Part 1 (no claim of conformity)"


class Table(NamedTuple):
    """A table of texts.

    Attributes
    ----------
    title : str
        Title.
    columns : tuple of str
        Headings.
    rows : sequence of tuple of str
        Cells.
    """

    title: str
    columns: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]


def tables(found: Assessment) -> list[Table]:
    """Return the tables of an assessment.

    Parameters
    ----------
    found : Assessment
        The assessment.

    Returns
    -------
    list of Table
        Zero deviations, displacement deviations, readings, and limits if there are any.
    """
    unit = found.unit or "mesh unit"
    zero = [("ZD, length of the displacement", _number(found.zd), unit)]
    zero += [
        (f"ZD along {name}", _number(value), unit)
        for name, value in zip("xy", found.zero_displacement[1:], strict=True)
    ]
    zero.append(("ZS, exx, eyy and exy together", _number(found.zs), ""))
    zero += [
        (f"ZS of {name}", _number(value), "")
        for name, value in zip(("exx", "eyy", "exy"), found.zero_strain[1:], strict=True)
    ]
    result = [
        Table(
            f"Zero deviations: rms over squares of {found.square:g} {unit}, {found.num_poses} poses, "
            f"{len(found.readings)} images",
            ("quantity", "value", "unit"),
            zero,
        )
    ]
    rows = [
        (f"displacement {name} ({unit})", str(each.num_readings), *map(_number, each[1:]))
        for name, each in zip("xy", found.along, strict=True)
    ]
    rows.append(("rotation (degrees)", str(found.rotation.num_readings), *map(_number, found.rotation[1:])))
    result.append(
        Table("Deviations: measured - set", ("quantity", "readings", "mean", "standard deviation", "largest"), rows)
    )
    result.append(
        Table(
            "Readings",
            ("pose", f"x ({unit})", f"y ({unit})", "degrees", "D x", "D y", "squares"),
            [
                (
                    reading.pose,
                    *(_number(value, 5) for value in reading.displacement),
                    _number(reading.rotation),
                    *map(_number, reading.deviation),
                    str(reading.squares),
                )
                for reading in found.readings
            ],
        )
    )
    if found.checks:
        verdicts = [
            (LIMITS[check.name], _number(check.value), f"{check.limit:g}", "yes" if check.holds else "NO")
            for check in found.checks
        ]
        result.append(Table("Limits of the user", ("quantity", "value", "limit", "holds"), verdicts))
    return result


def notes(found: Assessment) -> list[str]:
    """Return what the tables do not say.

    Parameters
    ----------
    found : Assessment
        The assessment.

    Returns
    -------
    list of str
        One sentence each.
    """
    unit = found.unit or "mesh units"
    said = []
    if math.isfinite(found.pixel.size):
        said.append(
            f"Pixel size from the set displacements: {found.pixel.size:.6g} {unit}, standard uncertainty "
            f"{_number(found.pixel.uncertainty, 2)}."
        )
    if found.not_measured or found.squares_left_out:
        said.append(
            f"Left out as not measured: {found.not_measured} nodes and {found.squares_left_out} squares, over all "
            "images."
        )
    if found.doubtful:
        said.append(f"{found.doubtful} of {len(found.readings)} images have a doubtful result.")
    return said


def markdown(found: Assessment, setup: Mapping[str, str] | None = None) -> str:
    """Return an assessment as Markdown.

    Parameters
    ----------
    found : Assessment
        The assessment.
    setup : mapping of str to str, optional
        Entries on the set-up.

    Returns
    -------
    str
        The text.
    """
    lines = [f"# {_TITLE}", "", f"fedic {__version__}.", ""]
    lines += [f"- {name}: {value}" for name, value in (setup or {}).items()]
    for title, columns, rows in tables(found):
        lines += ["", f"## {title}", "", _row(columns), _row(["---"] * len(columns)), *map(_row, rows)]
    lines += ["", *(f"{sentence}\n" for sentence in notes(found))]
    if found.checks:
        lines.append(f"Verdict: {'all limits hold' if found.within_limits else 'a limit is exceeded'}.")
    return "\n".join(lines).rstrip() + "\n"


def write_assessment(found: Assessment, path: Path, setup: Mapping[str, str] | None = None) -> None:
    """Write an assessment to a file, whole or not at all.

    Parameters
    ----------
    found : Assessment
        The assessment.
    path : Path
        Ends in ``.md`` or ``.json``.
    setup : mapping of str to str, optional
        Entries on the set-up.

    Raises
    ------
    OptionError
        If the suffix is unknown.
    FedicError
        If the file cannot be written.
    """
    if path.suffix.lower() == ".json":
        write_json(path, {"fedic": __version__, "setup": dict(setup or {}), **found.summary()})
    elif path.suffix.lower() == ".md":
        with atomic_path(path) as temporary:
            temporary.write_text(markdown(found, setup), encoding="utf-8")
    else:
        raise OptionError(f"{path}: an assessment cannot be written as {path.suffix!r}; choose .md or .json.", "path")


def _row(cells: "tuple[str, ...] | list[str]") -> str:
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"


def _number(value: float, digits: int = 3) -> str:
    return f"{value:.{digits}g}" if math.isfinite(value) else "not known"
