"""What a calibration found."""

from dataclasses import dataclass
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
    """What became of one image.

    Attributes
    ----------
    name : str
        The image file, or ``"image 3"`` for an array.
    found, accepted : bool
        Whether the target was found, and whether its points belong with those of the other views.
    reason : str
        Why it was not; empty if accepted.
    points : ndarray, shape (n, 3)
        Points of the target found; none if it was not.
    pixels : ndarray, shape (n, 2)
        Where they are seen.
    residuals : ndarray, shape (n, 2)
        Seen minus projected, in pixels.
    used : ndarray of bool, shape (n,)
        The points that count; the others are too far off.
    initial_error, final_error : float
        Root mean square distance in pixels before the fit (focal length from the homographies, no lens) and after it
        (of the points that count); NaN if not found.
    rotation : ndarray, shape (3, 3)
        From the target to the camera; NaN if not found. See `fedic.calibration.Target` for the target's frame.
    translation : ndarray, shape (3,)
        In the target's unit.
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
    """A calibrated camera, how well it is known, and from what.

    Attributes
    ----------
    camera : Pinhole
        The camera; its world is the target as the view `view` sees it.
    view : int
        Index of that view.
    reprojection_error : float
        Root mean square distance, in pixels, of all the points that count.
    views : tuple of View
        One per image.
    parameters : dict of str to float
        ``fx fy cx cy`` and the free ones of ``k1 k2 k3 d1 d2 p1 p2``.
    standard_deviations : dict of str to float
        Of each parameter, from the scatter of the points.
    covariance : ndarray, shape (p + 6 n, p + 6 n)
        Of the parameters in their order, then for each of the n accepted views of a rotation about the camera's axes
        (radians) and of the translation.
    image_size : (int, int)
        Width and height in pixels.
    advice : list of str
        What would make the calibration better; empty if nothing.
    distortion : str
        The lens model.
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
            "image_size": list(self.image_size),
            "reprojection_error": self.reprojection_error,
            "views_accepted": sum(view.accepted for view in self.views),
            "views_given": len(self.views),
            "pose_of": Path(self.views[self.view].name).name,
            "distortion": self.distortion,
            **{f"std_{name}": deviation for name, deviation in self.standard_deviations.items()},
        }
