"""Finite-element digital image correlation written in the physical space.

Two images of a speckled specimen, a finite element mesh and a calibrated camera in; the displacement of the nodes, in
the mesh's own unit, out:

>>> import fedic
>>> mesh = fedic.rectangle_mesh((100, 100, 400, 300), size=20)
>>> result = fedic.correlate(reference, deformed, mesh)  # doctest: +SKIP

Conventions: an image point is ``(u, v)``, ``u`` the column to the right and ``v`` the row downwards, with the centre of
the top-left pixel at ``(0, 0)``; a NumPy image is ``image[v, u]``. Strains are Green-Lagrange
strains unless another measure is asked for, positive in tension.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from fedic import _lenses, synthetic
from fedic._core import (
    CELL_TYPES,
    FrontParallel,
    ImageFrame,
    Mesh,
    MeshSet,
    Pinhole,
    __version__,
    rectangle_mesh,
)
from fedic._lenses import *  # noqa: F403
from fedic.correlation import Correlator, correlate
from fedic.errors import (
    CalibrationWarning,
    CameraError,
    ConfigError,
    ConvergenceWarning,
    FedicError,
    ImageError,
    MeshError,
    OptionError,
    QualityWarning,
    SolveError,
)
from fedic.io.images import read_image
from fedic.io.meshes import read_mesh
from fedic.meshing import unstructured_mesh
from fedic.progress import Progress
from fedic.quadrature import MeshQuadrature, PixelQuadrature
from fedic.regularization import EquilibriumGap
from fedic.results import Attempt, Covariance, Iteration, Quality, Result, Strains

if TYPE_CHECKING:
    from fedic.advise import Advice, advise_element_size
    from fedic.assess import Assessment, Pose, assess_poses
    from fedic.calibration import Calibration, calibrate
    from fedic.calibration.specimen import SpecimenCalibration, calibrate_on_specimen
    from fedic.cameras.files import read_camera, write_camera
    from fedic.campaign import Campaign, FrameRecord, load
    from fedic.cross_validation import RegularizationCurve, regularization_curve
    from fedic.noise import CameraNoise, NoiseFloor, camera_noise, noise_floor
    from fedic.probes import Gauge
    from fedic.registration import Registration, boundary_features, register

__all__ = [
    "CELL_TYPES",
    "Advice",
    "Assessment",
    "Attempt",
    "Calibration",
    "CalibrationWarning",
    "CameraError",
    "CameraNoise",
    "Campaign",
    "ConfigError",
    "ConvergenceWarning",
    "Correlator",
    "Covariance",
    "EquilibriumGap",
    "FedicError",
    "FrameRecord",
    "FrontParallel",
    "Gauge",
    "ImageError",
    "ImageFrame",
    "Iteration",
    "Mesh",
    "MeshError",
    "MeshQuadrature",
    "MeshSet",
    "NoiseFloor",
    "OptionError",
    "Pinhole",
    "PixelQuadrature",
    "Pose",
    "Progress",
    "Quality",
    "QualityWarning",
    "Registration",
    "RegularizationCurve",
    "Result",
    "SolveError",
    "SpecimenCalibration",
    "Strains",
    "__version__",
    "advise_element_size",
    "assess_poses",
    "boundary_features",
    "calibrate",
    "calibrate_on_specimen",
    "camera_noise",
    "correlate",
    "load",
    "noise_floor",
    "read_camera",
    "read_image",
    "read_mesh",
    "rectangle_mesh",
    "register",
    "regularization_curve",
    "synthetic",
    "unstructured_mesh",
    "write_camera",
]
__all__ += _lenses.__all__

_LAZY = {
    "Campaign": "campaign",
    "FrameRecord": "campaign",
    "load": "campaign",
    "Calibration": "calibration",
    "calibrate": "calibration",
    "read_camera": "cameras.files",
    "write_camera": "cameras.files",
    "RegularizationCurve": "cross_validation",
    "regularization_curve": "cross_validation",
    "Gauge": "probes",
    "Registration": "registration",
    "boundary_features": "registration",
    "register": "registration",
    "SpecimenCalibration": "calibration.specimen",
    "calibrate_on_specimen": "calibration.specimen",
    "Advice": "advise",
    "advise_element_size": "advise",
    "Assessment": "assess",
    "Pose": "assess",
    "assess_poses": "assess",
    "CameraNoise": "noise",
    "NoiseFloor": "noise",
    "camera_noise": "noise",
    "noise_floor": "noise",
}
"""Names imported on first use and their modules, which a measurement does not need."""


def __getattr__(name: str) -> object:
    module = _LAZY.get(name, name)
    if module not in _LAZY.values():
        raise AttributeError(f"module 'fedic' has no attribute {name!r}")
    found = import_module(f"fedic.{module}")
    return found if name == module else getattr(found, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
