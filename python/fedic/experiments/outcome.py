"""Input and outcome of an experiment, and the files of an outcome."""

import csv
import math
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, TypeAlias

from matplotlib.figure import Figure

from fedic._core import __version__
from fedic._internal.types import Image
from fedic.io.atomic import atomic_path, write_json
from fedic.plotting import save_figure
from fedic.progress import Progress, ProgressCallback, fraction_callback

__all__ = ["Claim", "Outcome", "Request", "Row", "write_outcome"]

Row: TypeAlias = dict[str, Any]
"""One row of an experiment's table: strings, numbers and booleans under keys that all rows share."""


@dataclass(frozen=True, eq=False)
class Request:
    """Input of an experiment.

    Attributes
    ----------
    quick : bool
        Use fewer sizes and draws, for a run under a minute.
    image : ndarray or None
        A real reference image, measured in addition to the synthetic one.
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
            A copy that reports the fraction of the part.
        """

        def report(progress: Progress) -> None:
            self.report((index + (progress.fraction or 0.0)) / count)

        return replace(self, progress=report)


@dataclass(frozen=True)
class Claim:
    """A claim and its evaluation.

    Attributes
    ----------
    text : str
        The claim, with its figure.
    measured : str
        The measured value.
    holds : bool
        True if the claim holds.
    """

    text: str
    measured: str
    holds: bool


@dataclass(frozen=True, eq=False)
class Outcome:
    """Outcome of an experiment.

    Attributes
    ----------
    name : str
        Name of the experiment and stem of its files.
    title : str
        Title, in one line.
    text : str
        Description of the method in Markdown.
    rows : list of dict
        Results, one row per measurement.
    claims : list of Claim
        Evaluated claims.
    figures : dict of str to Figure
        Figures by the ending of their file name: ``""`` for the main one.
    """

    name: str
    title: str
    text: str
    rows: list[Row]
    claims: list[Claim]
    figures: dict[str, Figure] = field(default_factory=dict)


def write_outcome(outcome: Outcome, folder: Path, *, quick: bool, seconds: float) -> None:
    """Write ``NAME.csv``, ``NAME.json`` and the pictures.

    Parameters
    ----------
    outcome : Outcome
        Outcome of an experiment.
    folder : Path
        An existing folder.
    quick : bool
        True for a quick run.
    seconds : float
        Duration of the run.
    """
    pictures = []
    for ending, figure in outcome.figures.items():
        pictures.append(f"{outcome.name}-{ending}.png" if ending else f"{outcome.name}.png")
        save_figure(figure, folder / pictures[-1])
    with (
        atomic_path(folder / f"{outcome.name}.csv") as temporary,
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
