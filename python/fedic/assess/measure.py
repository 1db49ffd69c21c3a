"""Measurement of the poses of a configuration."""

import warnings
from collections.abc import Mapping

from fedic.assess.assessment import Assessment
from fedic.assess.config import AssessConfig
from fedic.assess.poses import Pose, assess_poses
from fedic.correlation import Correlator
from fedic.errors import ConvergenceWarning, QualityWarning
from fedic.io.images import read_image
from fedic.progress import ProgressCallback

__all__ = ["measure_poses"]


def measure_poses(
    config: AssessConfig, *, limits: Mapping[str, float] | None = None, progress: ProgressCallback | None = None
) -> Assessment:
    """Measure every image of a configuration against the reference image, and assess the results.

    Parameters
    ----------
    config : AssessConfig
        From `load_assess_config`.
    limits : mapping of str to float, optional
        Limits that take the place of those of the configuration.
    progress : callable, optional
        Called with a `fedic.Progress`.

    Returns
    -------
    Assessment
        The deviations and the verdict.

    Raises
    ------
    ImageError, MeshError, CameraError, SolveError, OptionError
        As `fedic.Correlator`, `Correlator.correlate` and `assess_poses`.
    """
    mesh = config.mesh.build()
    reference = read_image(config.images.reference, mapped=True)
    correlator = Correlator(
        reference, mesh, config.camera.build(), unit=config.mesh.unit, **config.correlation.options()
    )
    poses = []
    with warnings.catch_warnings():
        # The number of doubtful results is part of the assessment.
        warnings.simplefilter("ignore", ConvergenceWarning)
        warnings.simplefilter("ignore", QualityWarning)
        for number, pose in enumerate(config.poses, start=1):
            results = [correlator.correlate(read_image(image, mapped=True), progress=progress) for image in pose.images]
            poses.append(Pose(pose.name or f"pose {number}", results, pose.displacement, pose.rotation))
    return assess_poses(
        poses,
        square=config.assessment.square,
        limits={**config.limits.given(), **(limits or {})},
        set_uncertainty=config.assessment.set_uncertainty,
    )
