"""Lens models that a calibration can fit."""

from fedic.calibration.lenses._coefficients import BROWN, RADIAL, SPLINES, CoefficientLens, Lens, parse_lens
from fedic.calibration.lenses._shape import SHAPES, ShapedTarget
from fedic.calibration.lenses._spline import SplineLens

__all__ = [
    "BROWN",
    "RADIAL",
    "SHAPES",
    "SPLINES",
    "CoefficientLens",
    "Lens",
    "ShapedTarget",
    "SplineLens",
    "parse_lens",
]
