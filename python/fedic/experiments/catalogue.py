"""The experiments by name."""

import warnings
from collections.abc import Callable
from importlib import import_module

from fedic.errors import ConvergenceWarning, FedicError, QualityWarning
from fedic.experiments.outcome import Outcome, Request

__all__ = ["EXPERIMENTS", "run_experiment"]

EXPERIMENTS = (
    "fig7",
    "fig8",
    "fig14",
    "fig15",
    "fig16",
    "noise",
    "interpolation",
    "resolution",
    "convergence",
    "distortion",
    "specimen",
    "splines",
    "strain",
)
"""Names, in the order of the report."""


def run_experiment(name: str, request: Request) -> Outcome:
    """Run one experiment.

    Parameters
    ----------
    name : str
        One of `EXPERIMENTS`.
    request : Request
        Its input.

    Returns
    -------
    Outcome
        Its outcome.

    Raises
    ------
    FedicError
        If there is no such experiment, or an image cannot be used.
    """
    if name not in EXPERIMENTS:
        raise FedicError(f"There is no experiment {name!r}; choose one of {', '.join(EXPERIMENTS)}, or all.")
    run: Callable[[Request], Outcome] = import_module(f"fedic.experiments.{name}").run
    with warnings.catch_warnings():
        # The truth is known, and some settings are meant to fail.
        warnings.simplefilter("ignore", ConvergenceWarning)
        warnings.simplefilter("ignore", QualityWarning)
        return run(request)
