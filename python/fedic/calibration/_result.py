"""Result of a calibration."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fedic._core import Pinhole
from fedic._internal.types import Floats
from fedic.cameras.result import CameraResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Calibration", "View"]


@dataclass(frozen=True, eq=False)
class View:
    """One image of a calibration.

    Attributes
    ----------
    name : str
        Image file, or ``"image 3"`` for an array.
    found, accepted : bool
        True if the target was found, and if its points are consistent with those of the other views.
    reason : str
        Reason of a rejection; empty if accepted.
    points : ndarray, shape (n, 3)
        Points of the target found, at the places that fit the views if the target is not as planned; empty without.
    pixels : ndarray, shape (n, 2)
        Their image points.
    residuals : ndarray, shape (n, 2)
        Measured minus projected image points, in pixels.
    used : ndarray of bool, shape (n,)
        False for outliers, which are left out of the fit.
    initial_error, final_error : float
        Root mean square distance in pixels before the fit (focal length from the homographies, no lens) and after it
        (without outliers); NaN if not found.
    rotation : ndarray, shape (3, 3)
        Rotation from the target to the camera; NaN if not found. See `fedic.calibration.Target` for the target's frame.
    translation : ndarray, shape (3,)
        Translation in the target's unit.
    """

    name: str
    found: bool
    accepted: bool
    reason: str
    points: Floats
    pixels: Floats
    residuals: Floats
    used: NDArray[np.bool_]
    initial_error: float
    final_error: float
    rotation: Floats
    translation: Floats


@dataclass(frozen=True, eq=False)
class Calibration(CameraResult):
    """A calibrated camera, its uncertainty and its residuals.

    Attributes
    ----------
    camera : Pinhole
        The camera; its world is the frame of the target in the view `view`.
    view : int
        Index of that view.
    reprojection_error : float
        Root mean square distance of the points used, in pixels.
    views : tuple of View
        One per image.
    parameters : dict of str to float
        ``fx fy cx cy`` and the free coefficients among ``k1 k2 k3 d1 d2 p1 p2``.
    standard_deviations : dict of str to float
        Standard deviation of each parameter, from the scatter of the points, enlarged where the residuals of
        neighbouring points are correlated (a lens or a target that the model does not describe).
    covariance : ndarray, shape (p + 6 n, p + 6 n)
        Covariance of the parameters in their order, then, for each of the n accepted views, of a rotation about the
        camera's axes (radians) and of the translation.
    image_size : (int, int)
        Width and height in pixels.
    advice : list of str
        Sentences on how to improve the calibration; empty if it is good.
    distortion : str
        Lens model.
    target_shape : dict of str to (float, float)
        Departures of the target from its plan that the views show, with their standard deviations; empty if there are
        none. ``stretch``: the pitch along Y is ``1 + stretch`` times the one given, that along X is as given.
        ``skew``: a point at Y is shifted by ``skew * Y`` along X. ``bend_xx``, ``bend_xy``, ``bend_yy``: a point is at
        ``Z = half * (bend_xx * x**2 + bend_xy * x * y + bend_yy * y**2)``, with x and y from the centre of the target
        in units of half its length.
    """

    camera: Pinhole
    view: int
    reprojection_error: float
    views: tuple[View, ...]
    parameters: dict[str, float]
    standard_deviations: dict[str, float]
    covariance: Floats
    image_size: tuple[int, int]
    advice: list[str]
    distortion: str
    target_shape: dict[str, tuple[float, float]] = field(default_factory=dict)

    def _figure(self) -> "Figure":
        from fedic.plotting.calibration import draw_residuals

        accepted = [view for view in self.views if view.accepted]
        return draw_residuals(
            np.concatenate([view.pixels for view in accepted]),
            np.concatenate([view.residuals for view in accepted]),
            np.concatenate([view.used for view in accepted]),
            image_size=self.image_size,
            principal_point=self.camera.principal_point,
            rms=self.reprojection_error,
            title=f"{len(accepted)} of {len(self.views)} views",
        )

    def _notes(self) -> dict[str, object]:
        return {
            "reprojection_error": self.reprojection_error,
            "views_accepted": sum(view.accepted for view in self.views),
            "views_given": len(self.views),
            "pose_of": Path(self.views[self.view].name).name,
            "distortion": self.distortion,
            **{f"std_{name}": deviation for name, deviation in self.standard_deviations.items()},
            **{f"target_{name}": value for name, (value, _) in self.target_shape.items()},
        }
