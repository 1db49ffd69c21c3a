"""What an experiment is asked, what it answers, and the files it leaves."""

import csv
import math
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, TypeAlias

from matplotlib.figure import Figure

from fedic._core import __version__
from fedic._internal.types import Image
from fedic.io.atomic import replacing, write_json
from fedic.plotting import save_figure
from fedic.progress import Progress, ProgressCallback, fraction_callback

__all__ = ["Claim", "Outcome", "Request", "Row", "write_outcome"]

Row: TypeAlias = dict[str, Any]
"""One line of an experiment's table, of strings, numbers and truth values: the same keys in all of them."""


@dataclass(frozen=True, eq=False)
class Request:
    """What an experiment is to run on.

    Attributes
    ----------
    quick : bool
        Fewer sizes and draws: a run under a minute, for a look and for the tests.
    image : ndarray or None
        A real reference image, measured beside the synthetic one.
    star : (ndarray, ndarray) or None
        Reference and deformed image of the star of the DIC Challenge 2.0, noisy pair.
    progress : callable, optional
        Called with a `fedic.Progress`.
    """

    quick: bool = False
    image: Image | None = None
    star: tuple[Image, Image] | None = None
    progress: ProgressCallback | None = None

    def report(self, fraction: float) -> None:
        """Report the completed fraction of the request.

        Parameters
        ----------
        fraction : float
            From 0 to 1.
        """
        fraction_callback(self.progress, "experiment")(fraction)

    def part(self, index: int, count: int) -> "Request":
        """Return the request for one of several equal parts of the work.

        Parameters
        ----------
        index, count : int
            Number of the part, from 0, and number of parts.

        Returns
        -------
        Request
            The same request; what it reports is the fraction of the part.
        """

        def report(progress: Progress) -> None:
            self.report((index + (progress.fraction or 0.0)) / count)

        return replace(self, progress=report)


@dataclass(frozen=True)
class Claim:
    """A claim and its verdict.

    Attributes
    ----------
    text : str
        What is claimed, with its figure.
    measured : str
        What was measured.
    holds : bool
        Whether it holds.
    """

    text: str
    measured: str
    holds: bool


@dataclass(frozen=True, eq=False)
class Outcome:
    """What an experiment found.

    Attributes
    ----------
    name : str
        Name of the experiment, of which those of its files are made.
    title : str
        Its subject, in a line.
    text : str
        What was done, in a few sentences; Markdown.
    rows : list of dict
        The numbers, one dictionary of equal keys per measurement.
    claims : list of Claim
        The verdicts.
    figures : dict of str to Figure
        The pictures, by the ending of their file's name: ``""`` for the main one.
    """

    name: str
    title: str
    text: str
    rows: list[Row]
    claims: list[Claim]
    figures: dict[str, Figure] = field(default_factory=dict)


def write_outcome(outcome: Outcome, folder: Path, *, quick: bool, seconds: float) -> None:
    """Write ``NAME.csv``, ``NAME.json`` and the pictures, each whole or not at all.

    Parameters
    ----------
    outcome : Outcome
        From an experiment.
    folder : Path
        An existing folder.
    quick : bool
        Whether the run was a quick one.
    seconds : float
        How long it took.
    """
    pictures = []
    for ending, figure in outcome.figures.items():
        pictures.append(f"{outcome.name}-{ending}.png" if ending else f"{outcome.name}.png")
        save_figure(figure, folder / pictures[-1])
    with (
        replacing(folder / f"{outcome.name}.csv") as temporary,
        temporary.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.DictWriter(file, fieldnames=list(outcome.rows[0]))
        writer.writeheader()
        writer.writerows(outcome.rows)
    content = {
        "fedic": __version__,
        "name": outcome.name,
        "title": outcome.title,
        "quick": quick,
        "seconds": round(seconds, 1),
        "text": outcome.text,
        "claims": [asdict(claim) for claim in outcome.claims],
        "pictures": pictures,
        "rows": [{key: _json_value(value) for key, value in row.items()} for row in outcome.rows],
    }
    write_json(folder / f"{outcome.name}.json", content)


def _json_value(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
