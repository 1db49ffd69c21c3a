"""Detection of calibration targets in images."""

from fedic.calibration.detection._find import NotFoundError, find_target
from fedic.calibration.detection._refinement import refined

__all__ = ["NotFoundError", "find_target", "refined"]
