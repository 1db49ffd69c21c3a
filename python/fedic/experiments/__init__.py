"""The experiments behind every claim: each measures, draws, and says whether the claim holds.

`run_experiment` runs one by name. An experiment is a function from a `Request` to an `Outcome`, in a module of its own
name; `write_outcome` and `write_report` put outcomes on disk.
"""

from fedic.experiments.catalogue import EXPERIMENTS, run_experiment
from fedic.experiments.outcome import Claim, Outcome, Request, write_outcome
from fedic.experiments.report import write_report

__all__ = ["EXPERIMENTS", "Claim", "Outcome", "Request", "run_experiment", "write_outcome", "write_report"]
