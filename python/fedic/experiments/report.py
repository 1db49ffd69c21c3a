"""Report with the claims and pictures of all experiments in a folder."""

import json
from pathlib import Path
from typing import Any

from fedic.experiments.catalogue import EXPERIMENTS
from fedic.io.atomic import atomic_path

__all__ = ["write_report"]

PAGE = "report.md"


def write_report(folder: Path) -> Path:
    """Write ``report.md`` from the outcomes found in a folder.

    Parameters
    ----------
    folder : Path
        Folder with files of `write_outcome`.

    Returns
    -------
    Path
        The report.
    """
    found = [_read(path) for name in EXPERIMENTS if (path := folder / f"{name}.json").exists()]
    lines = [
        "# Experiments",
        "",
        "Each can be run again by `fedic experiment NAME`, all of them by `fedic experiment all`. The numbers behind "
        "the pictures are in the CSV and JSON files beside this page.",
        "",
        "| experiment | claims that hold | fedic | run |",
        "| --- | --- | --- | --- |",
    ]
    for outcome in found:
        held = sum(claim["holds"] for claim in outcome["claims"])
        link = f"[{outcome['title']}](#{outcome['name']})"
        run = f"{'quick, ' if outcome['quick'] else ''}{outcome['seconds']:.0f} s"
        lines.append(f"| {link} | {held} of {len(outcome['claims'])} | {outcome['fedic']} | {run} |")
    for outcome in found:
        lines += ["", *_section(outcome)]
    page = folder / PAGE
    with atomic_path(page) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return page


def _read(path: Path) -> dict[str, Any]:
    outcome: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return outcome


def _section(outcome: dict[str, Any]) -> list[str]:
    name = outcome["name"]
    lines = [
        f'<a id="{name}"></a>',
        "",
        f"## {outcome['title']}",
        "",
        f"`fedic experiment {name}`. {outcome['text'].strip()}",
        "",
    ]
    lines += ["| claim | measured | holds |", "| --- | --- | --- |"]
    for claim in outcome["claims"]:
        cells = [str(claim["text"]), str(claim["measured"]), "yes" if claim["holds"] else "**no**"]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    lines.append("")
    for picture in outcome["pictures"]:
        lines += [f"![{outcome['title']}]({picture})", ""]
    lines.append(f"Numbers: [{name}.csv]({name}.csv), [{name}.json]({name}.json).")
    return lines
