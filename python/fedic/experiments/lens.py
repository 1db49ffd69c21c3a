"""The scene of Sect. 5.2 of the paper: a speckled plane moved by hundreds of pixels before a lens that distorts."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import BrownDistortion, Mesh, Pinhole
from fedic._internal.types import CellName, Distortion, Floats
from fedic.experiments.subjects import LEVELS, SPECKLE, Window, window_mesh
from fedic.synthetic import Speckle, render

__all__ = ["BOUNDS", "FOCAL", "MILLIMETRES", "PIXEL_MOTION", "RADIAL", "ROUNDING", "Pair", "Scene", "textures"]

WIDTH, HEIGHT = 1388, 1036
FOCAL = 8381.24
PRINCIPAL_POINT = (706.053, 503.725)
RADIAL = (-0.0321253, 0.0, 0.0)
MILLIMETRES = 1630.0 / FOCAL
"""Per pixel on the optical axis, the plane being 1630 mm away."""
PIXEL_MOTION = (-400.0, -200.0)
"""The paper samples its texture at X + S with S = (400, 200) px: the material moves by -S."""
BOUNDS = (800.3, 500.2, 1100.3, 800.2)
"""Of the mesh, in pixels."""
ROUNDING = 1.0 / np.sqrt(12.0)
"""Standard deviation of the rounding to whole grey levels."""
_STEPS_OF_8_BITS = 65535 // 255


@dataclass(frozen=True, eq=False)
class Pair:
    """The plane at rest and moved.

    Attributes
    ----------
    reference, deformed : ndarray of uint16 or uint8, shape (height, width)
        The images.
    """

    reference: NDArray[Any]
    deformed: NDArray[Any]

    def rounded(self) -> "Pair":
        """Return 16-bit images in 8 bits.

        Returns
        -------
        Pair
            Rounded to the nearest of 256 grey levels.
        """
        f, g = (np.rint(image / _STEPS_OF_8_BITS).astype(np.uint8) for image in (self.reference, self.deformed))
        return Pair(f, g)


@dataclass(frozen=True, eq=False)
class Scene:
    """The plane, the camera and the place of the mesh.

    Attributes
    ----------
    distortion : BrownDistortion, SplineDistortion or InverseSplineDistortion
        Of the lens; the paper's unless given.
    focal : float
        Focal length in pixels. The plane is as far away as keeps the scale of the image on the optical axis.
    sensor : (int, int, int, int)
        Left, top, right and bottom of the part of the sensor that is rendered, right and bottom excluded. Pixels are
        counted from its corner.
    pixel_motion : (float, float)
        Motion of the material along ``u`` and ``v`` in pixels of the optical axis; the paper's unless given.
    """

    distortion: Distortion = field(default_factory=lambda: BrownDistortion(radial=RADIAL))
    focal: float = FOCAL
    sensor: tuple[int, int, int, int] = (0, 0, WIDTH, HEIGHT)
    pixel_motion: tuple[float, float] = PIXEL_MOTION

    @property
    def camera(self) -> Pinhole:
        """The calibrated camera, in millimetres."""
        left, top, _, _ = self.sensor
        return Pinhole(
            (self.focal, self.focal),
            (PRINCIPAL_POINT[0] - left, PRINCIPAL_POINT[1] - top),
            rotation=np.diag([1.0, -1.0, -1.0]),
            translation=(0.0, 0.0, MILLIMETRES * self.focal),
            distortion=self.distortion,
        )

    @property
    def window(self) -> Window:
        """Bounds of the mesh in the rendered image, in pixels."""
        left, top, _, _ = self.sensor
        return BOUNDS[0] - left, BOUNDS[1] - top, BOUNDS[2] - left, BOUNDS[3] - top

    @property
    def motion(self) -> tuple[float, float]:
        """Motion of the material along ``X`` and ``Y``, in millimetres: Y is up, v is down."""
        u, v = self.pixel_motion
        return u * MILLIMETRES, -v * MILLIMETRES

    def mesh(self, size: float, cell: CellName) -> Mesh:
        """Make the unstructured mesh, in pixels.

        Parameters
        ----------
        size : float
            Edge of the elements, in pixels.
        cell : str
            Their kind.

        Returns
        -------
        Mesh
            Of 300 x 300 px.
        """
        return window_mesh(self.window, size, cell)

    def in_millimetres(self, mesh: Mesh) -> Mesh:
        """Bring a mesh in pixels back to the plane, node by node.

        Parameters
        ----------
        mesh : Mesh
            In pixels.

        Returns
        -------
        Mesh
            The one whose nodes are seen there.
        """
        return Mesh(self.camera.unproject(mesh.points)[:, :2], mesh.cells)

    def neglected(self, mesh: Mesh) -> Floats:
        """Compute what a measurement in pixels takes for displacement: the distortion there minus that here.

        Parameters
        ----------
        mesh : Mesh
            In pixels.

        Returns
        -------
        ndarray of float, shape (n, 2)
            Motion seen in the image minus that without distortion, in pixels, of each node.
        """
        plane = self.camera.unproject(mesh.points)
        moved: Floats = self.camera.project(plane + np.array([*self.motion, 0.0]))
        return moved - mesh.points - self.pixel_motion

    def pair(self, seed: int, progress: Callable[[float], object] | None = None) -> Pair:
        """Render a texture at rest and moved, in 16 bits and without noise.

        Parameters
        ----------
        seed : int
            Of the texture.
        progress : callable, optional
            Called with the fraction of each image done.

        Returns
        -------
        Pair
            See `Pair.rounded` for those of the paper, in 8 bits.
        """
        left, top, right, bottom = self.sensor
        shape = (bottom - top, right - left)
        texture = Speckle(SPECKLE * MILLIMETRES, seed=seed)
        reference = render(texture, self.camera, shape, levels=LEVELS, bits=16, progress=progress)
        deformed = render(
            texture, self.camera, shape, displacement=self.motion, levels=LEVELS, bits=16, progress=progress
        )
        return Pair(reference, deformed)

    def rounding_floor(self, pair: Pair) -> Floats:
        """Estimate the standard error, by rounding alone, of one translation measured over the whole mesh.

        Parameters
        ----------
        pair : Pair
            In 8 bits.

        Returns
        -------
        ndarray of float, shape (2,)
            Along ``u`` and ``v``, in pixels: no mean over the nodes can be expected to be nearer to the truth.
        """
        left, top, right, bottom = np.rint(self.window).astype(int)
        along_v, along_u = np.gradient(pair.reference[top:bottom, left:right].astype(np.float64))
        slopes = np.stack([along_u.ravel(), along_v.ravel()])
        floor: Floats = np.sqrt(2.0 * ROUNDING**2 * np.diag(np.linalg.inv(slopes @ slopes.T)))
        return floor


@lru_cache(maxsize=8)
def _texture(seed: int) -> Pair:
    return Scene().pair(seed)


def textures(count: int) -> list[Pair]:
    """Return pairs of the paper's scene, each rendered once.

    Parameters
    ----------
    count : int
        How many textures.

    Returns
    -------
    list of Pair
        In 16 bits.
    """
    return [_texture(seed) for seed in range(count)]
