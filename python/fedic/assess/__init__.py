"""Assessment of a measurement on static images and known rigid motions, after EN 4861 and VDI/VDE 2626."""

from fedic.assess.assessment import Assessment, Check, Reading
from fedic.assess.config import AssessConfig, load_assess_config
from fedic.assess.measure import measure_poses
from fedic.assess.poses import Pose, assess_poses
from fedic.assess.report import markdown, write_assessment

__all__ = [
    "AssessConfig",
    "Assessment",
    "Check",
    "Pose",
    "Reading",
    "assess_poses",
    "load_assess_config",
    "markdown",
    "measure_poses",
    "write_assessment",
]
