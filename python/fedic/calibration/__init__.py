"""Calibration of a camera from images of a flat target.

`fedic.calibrate` is the whole procedure; `find_target` and `calibrate_points` are its two halves.
"""

from fedic.calibration._from_images import calibrate
from fedic.calibration._from_points import calibrate_points
from fedic.calibration._result import Calibration, View
from fedic.calibration.detection import NotFoundError, find_target
from fedic.calibration.target import Target, parse_target

__all__ = [
    "Calibration",
    "NotFoundError",
    "Target",
    "View",
    "calibrate",
    "calibrate_points",
    "find_target",
    "parse_target",
]
