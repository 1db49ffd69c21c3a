"""Detection of calibration targets in images, and refinement of their points."""

from fedic.calibration.detection._find import NotFoundError, WrongCountError, find_target
from fedic.calibration.detection._refinement import refine_points

__all__ = ["NotFoundError", "WrongCountError", "find_target", "refine_points"]
