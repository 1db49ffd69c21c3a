"""The length of a regularization, chosen by pixels that the measurement does not see."""

from fedic.cross_validation.curve import RegularizationCurve
from fedic.cross_validation.measure import regularization_curve

__all__ = ["RegularizationCurve", "regularization_curve"]
