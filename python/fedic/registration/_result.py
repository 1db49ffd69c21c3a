"""What a registration found."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats, Image, StrPath
from fedic.cameras.files import write_camera
from fedic.cameras.files.matrices import matrices_of_camera
from fedic.registration._pose import Placeable

__all__ = ["FeatureDistances", "Registration", "check_format"]


def check_format(start: object, path: Path) -> None:
    """Check, before any long work, that a file can hold the camera: the lens and the skew are those of the start.

    Raises
    ------
    CameraError
        If the format of the file cannot express them.
    """
    if path.suffix.lower() != ".toml":
        matrices_of_camera(path, start)


@dataclass(frozen=True, eq=False)
class FeatureDistances:
    """What is left between a feature of the mesh and the edge in the image.

    Attributes
    ----------
    name : str
        Of the feature.
    pixels : ndarray, shape (n, 2)
        The edge in the image, one point for each piece of about 12 px that the feature was cut into.
    distances : ndarray, shape (n,)
        From the projected feature to these points, in pixels, positive out of the material.
    used : ndarray of bool, shape (n,)
        The pieces that count; the others show no edge, or one too far off.
    noise : float
        Standard deviation, in pixels, of the distance of one piece, enlarged where neighbouring ones are correlated.
    """

    name: str
    pixels: Floats
    distances: Floats
    used: NDArray[np.bool_]
    noise: float

    @property
    def median(self) -> float:
        """Median distance without sign of the pieces that count, in pixels."""
        return float(np.median(np.abs(self.distances[self.used])))

    @property
    def rms(self) -> float:
        """Root mean square distance of the pieces that count, in pixels."""
        return float(np.sqrt((self.distances[self.used] ** 2).mean()))


@dataclass(frozen=True, eq=False)
class Registration:
    """A camera placed before a mesh, how well it is known, and from what.

    Attributes
    ----------
    camera : FrontParallel or Pinhole
        Projects the mesh to where the specimen is seen.
    free : tuple of str
        The parameters that were found: of ``u0 v0 angle scale`` or of ``rx ry rz tx ty tz``, the latter a rotation of
        the mesh about its origin and the camera's axes, from where it is now, and the translation.
    covariance : ndarray, shape (p, p)
        Of the parameters in the order of `free`, in pixels, radians and the mesh's unit; NaN where as many data as
        unknowns leave it open.
    standard_deviations : dict of str to float
        Of each parameter.
    features : dict of str to FeatureDistances
        What is left at each feature.
    points : ndarray, shape (m, 3)
        The points given, or those of the target, in the mesh's frame.
    pixels : ndarray, shape (m, 2)
        Where they are seen.
    residuals : ndarray, shape (m, 2)
        Seen minus projected, in pixels.
    mesh : Mesh
        The mesh.
    image : ndarray, shape (height, width)
        The image.
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

    def plot(self, path: StrPath) -> None:
        """Draw the mesh over the image, with the edges and points found, coloured by their distance.

        Parameters
        ----------
        path : str or path
            The ``.png`` file; replaced if it exists.

        Raises
        ------
        FedicError
            If the suffix is another, or it cannot be written.
        """
        from fedic.plotting.calibration import check_picture
        from fedic.plotting.fields import save_figure
        from fedic.plotting.registration import draw_registration

        check_picture(Path(path))
        save_figure(draw_registration(self), Path(path))

    def write(self, path: StrPath, *, overwrite: bool = False) -> Path:
        """Write the camera, see `fedic.write_camera`; a ``.toml`` file also says how well it is known.

        Parameters
        ----------
        path : str or path
            Ends in ``.toml``, ``.yml``, ``.yaml`` or ``.xml``.
        overwrite : bool
            Whether a file that exists may be replaced.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        CameraError
            If the file exists, or the suffix is another.
        FedicError
            If it cannot be written.
        """
        notes: dict[str, object] = {f"std_{name}": value for name, value in self.standard_deviations.items()}
        for name, found in self.features.items():
            notes[f"median_distance_{name.replace(' ', '_')}"] = found.median
        return write_camera(self.camera, path, overwrite=overwrite, notes=notes)
