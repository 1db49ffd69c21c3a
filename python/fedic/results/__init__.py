"""Results of a measurement: the displacement field, what follows from it, and the verdict on it."""

from fedic.results.attempt import Attempt
from fedic.results.covariance import Covariance
from fedic.results.quality import Quality
from fedic.results.result import Iteration, Result
from fedic.results.rigid import RigidMotion
from fedic.results.strains import StrainAxes, StrainMeasure, Strains

__all__ = [
    "Attempt",
    "Covariance",
    "Iteration",
    "Quality",
    "Result",
    "RigidMotion",
    "StrainAxes",
    "StrainMeasure",
    "Strains",
]
