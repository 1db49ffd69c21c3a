"""Calibration of a camera from images of a flat target.

`fedic.calibrate` does all of it; this package also has its parts. A lens model beyond the coefficients of
`fedic.BrownDistortion` starts in `fedic.calibration.lenses`, where the words of `distortion` are read.
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
