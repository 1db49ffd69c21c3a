"""Lens models that a calibration can fit."""

from fedic.calibration.lenses._brown import BROWN, RADIAL, SPLINES, BrownLens, Lens, parse_lens
from fedic.calibration.lenses._spline import SplineLens

__all__ = ["BROWN", "RADIAL", "SPLINES", "BrownLens", "Lens", "SplineLens", "parse_lens"]
