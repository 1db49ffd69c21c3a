"""Results of a measurement: the displacement field and what follows from it."""

from fedic.results.result import Iteration, Result
from fedic.results.strains import StrainAxes, StrainMeasure, Strains

__all__ = ["Iteration", "Result", "StrainAxes", "StrainMeasure", "Strains"]
