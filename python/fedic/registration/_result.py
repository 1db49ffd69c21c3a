"""Result of a registration."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats, Image
from fedic.cameras.files.matrices import matrices_of_camera
from fedic.cameras.result import CameraResult
from fedic.registration._pose import Placeable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["FeatureDistances", "Registration", "check_format"]


def check_format(start: object, path: Path) -> None:
    """Check, before any long work, that the format of a file can hold the lens and the skew of a camera.

    Parameters
    ----------
    start : object
        The camera to be written.
    path : Path
        The file; its suffix is its format.

    Raises
    ------
    CameraError
        If the format cannot hold the camera.
    """
    if path.suffix.lower() != ".toml":
        matrices_of_camera(path, start)


@dataclass(frozen=True, eq=False)
class FeatureDistances:
    """Distances between a feature of the mesh and its edge in the image.

    Attributes
    ----------
    name : str
        Name of the feature.
    pixels : ndarray, shape (n, 2)
        Points of the edge in the image, one for each segment of about 12 px of the feature.
    distances : ndarray, shape (n,)
        Distances from the projected feature to these points, in pixels, positive out of the material.
    used : ndarray of bool, shape (n,)
        False for segments that show no edge, or one too far away.
    noise : float
        Standard deviation of the distance of one segment in pixels, including the correlation of neighbours.
    """

    name: str
    pixels: Floats
    distances: Floats
    used: NDArray[np.bool_]
    noise: float

    @property
    def median(self) -> float:
        """Median absolute distance of the segments used, in pixels."""
        return float(np.median(np.abs(self.distances[self.used])))

    @property
    def rms(self) -> float:
        """Root mean square distance of the segments used, in pixels."""
        return float(np.sqrt((self.distances[self.used] ** 2).mean()))


@dataclass(frozen=True, eq=False)
class Registration(CameraResult):
    """A camera with its pose in the frame of a mesh, its uncertainty and its residuals.

    Attributes
    ----------
    camera : FrontParallel or Pinhole
        The camera that projects the mesh onto the specimen in the image.
    free : tuple of str
        Estimated parameters: any of ``u0 v0 angle scale`` or of ``rx ry rz tx ty tz``, the latter a rotation of the
        mesh about its origin and the camera's axes, relative to this camera, and the translation.
    covariance : ndarray, shape (p, p)
        Covariance of the parameters in the order of `free`, in pixels, radians and the mesh's unit; NaN if there are no
        more data than unknowns.
    standard_deviations : dict of str to float
        Standard deviation of each parameter.
    features : dict of str to FeatureDistances
        Distances of each feature.
    points : ndarray, shape (m, 3)
        Points given, or those of the target, in the mesh's frame.
    pixels : ndarray, shape (m, 2)
        Their image points.
    residuals : ndarray, shape (m, 2)
        Measured minus projected image points, in pixels.
    mesh : Mesh
        The mesh.
    image : ndarray, shape (height, width)
        The image.
    doubts : tuple of str
        What is doubtful, in sentences: features whose edge lies to one side of them all along, and the orientation of
        the mesh if another fits better.
    """

    camera: Placeable
    free: tuple[str, ...]
    covariance: Floats
    standard_deviations: dict[str, float]
    features: dict[str, FeatureDistances]
    points: Floats
    pixels: Floats
    residuals: Floats
    mesh: Mesh
    image: Image
    doubts: tuple[str, ...] = ()

    def _figure(self) -> "Figure":
        from fedic.plotting.registration import draw_registration

        found = list(self.features.values())
        edges = None
        if found:
            edges = (
                np.concatenate([each.pixels for each in found]),
                np.concatenate([each.distances for each in found]),
                np.concatenate([each.used for each in found]),
            )
        lines = [
            f"{each.name}: {each.median:.2f} px median, {each.used.sum()} of {len(each.used)} segments"
            for each in found
        ]
        if len(self.residuals):
            rms = float(np.sqrt((self.residuals**2).sum(axis=1).mean()))
            lines.append(f"{len(self.residuals)} points: {rms:.3f} px rms")
        if self.doubts:
            lines.append("DOUBTFUL, see the warnings")
        points = (self.pixels, self.residuals)
        return draw_registration(self.mesh, self.camera, self.image, edges=edges, points=points, lines=lines)

    def _notes(self) -> dict[str, object]:
        notes: dict[str, object] = {f"std_{name}": value for name, value in self.standard_deviations.items()}
        for name, found in self.features.items():
            notes[f"median_distance_{name.replace(' ', '_')}"] = found.median
        if self.doubts:
            notes["doubts"] = list(self.doubts)
        return notes
