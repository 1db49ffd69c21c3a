"""Experiments that check the claims on accuracy: each measures, draws, and evaluates its claims.

`run_experiment` runs one by name. An experiment is a function ``run`` from a `Request` to an `Outcome`, in a module of
its name; `write_outcome` and `write_report` write outcomes to files. Nothing else imports this package.
"""

from fedic.experiments.catalogue import EXPERIMENTS, run_experiment
from fedic.experiments.outcome import Claim, Outcome, Request, write_outcome
from fedic.experiments.report import write_report

__all__ = ["EXPERIMENTS", "Claim", "Outcome", "Request", "run_experiment", "write_outcome", "write_report"]
