"""The scene of Sect. 5.2 of Pierré et al.: a large motion of a speckled plane in front of a distorting lens."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import BrownDistortion, Distortion, Mesh, Pinhole
from fedic._internal.types import Floats
from fedic.progress import ProgressCallback
from fedic.synthetic import Speckle, render

__all__ = ["LEVELS", "SPECKLE", "ImagePair", "Scene"]

SPECKLE = 5.5
"""Size of the speckles in pixels."""
LEVELS = (0.04, 0.96)
"""Grey levels of the texture: with this speckle a standard deviation of 57 and a gradient of 24 per pixel and axis."""

WIDTH, HEIGHT = 1388, 1036
FOCAL = 8381.24
PRINCIPAL_POINT = (706.053, 503.725)
RADIAL = (-0.0321253, 0.0, 0.0)
MILLIMETRES = 1630.0 / FOCAL
"""Millimetres per pixel on the optical axis; the plane is 1630 mm away."""
PIXEL_MOTION = (-400.0, -200.0)
"""Motion in pixels. The paper samples its texture at X + S with S = (400, 200) px: the material moves by -S."""
BOUNDS = (800.3, 500.2, 1100.3, 800.2)
"""Bounds of the mesh in pixels."""
_LEVELS_16_PER_8_BITS = 65535 // 255


@dataclass(frozen=True, eq=False)
class ImagePair:
    """The plane at rest and moved.

    Attributes
    ----------
    reference, deformed : ndarray of uint16 or uint8, shape (height, width)
        The images.
    """

    reference: NDArray[Any]
    deformed: NDArray[Any]

    def rounded(self) -> "ImagePair":
        """Round 16-bit images to 8 bits.

        Returns
        -------
        ImagePair
            Images of uint8.
        """
        f, g = (np.rint(image / _LEVELS_16_PER_8_BITS).astype(np.uint8) for image in (self.reference, self.deformed))
        return ImagePair(f, g)


@dataclass(frozen=True, eq=False)
class Scene:
    """The plane, the camera and the position of the mesh.

    Attributes
    ----------
    distortion : BrownDistortion, SplineDistortion or InverseSplineDistortion
        Lens; by default the paper's.
    focal : float
        Focal length in pixels. The distance of the plane keeps the scale of the image on the optical axis.
    sensor : (int, int, int, int)
        Left, top, right and bottom of the part of the sensor that is rendered, right and bottom excluded. Image points
        count from its corner.
    pixel_motion : (float, float)
        Motion of the material along ``u`` and ``v`` in pixels of the optical axis; by default the paper's.
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
    def window(self) -> tuple[float, float, float, float]:
        """Bounds of the mesh in the rendered image, in pixels."""
        left, top, _, _ = self.sensor
        return BOUNDS[0] - left, BOUNDS[1] - top, BOUNDS[2] - left, BOUNDS[3] - top

    @property
    def motion(self) -> tuple[float, float]:
        """Motion of the material along ``X`` and ``Y`` in millimetres; ``Y`` points up, ``v`` down."""
        u, v = self.pixel_motion
        return u * MILLIMETRES, -v * MILLIMETRES

    def in_millimetres(self, mesh: Mesh) -> Mesh:
        """Unproject a mesh in pixels to the plane, node by node.

        Parameters
        ----------
        mesh : Mesh
            The mesh in pixels.

        Returns
        -------
        Mesh
            The mesh in millimetres, which the camera projects to the given one.
        """
        return Mesh(self.camera.unproject(mesh.points)[:, :2], mesh.cells)

    def in_pixels(self, vectors: Floats) -> Floats:
        """Convert vectors of the plane from millimetres to pixels of the optical axis.

        Parameters
        ----------
        vectors : ndarray, shape (n, 2)
            Vectors in millimetres.

        Returns
        -------
        ndarray, shape (n, 2)
            The vectors along ``u`` and ``v``.
        """
        return vectors / MILLIMETRES * (1.0, -1.0)

    def pair(self, seed: int, progress: ProgressCallback | None = None) -> ImagePair:
        """Render a texture at rest and moved, in 16 bits and without noise.

        Parameters
        ----------
        seed : int
            Seed of the texture.
        progress : callable, optional
            Called with a `fedic.Progress` of each image.

        Returns
        -------
        ImagePair
            Images of uint16; `ImagePair.rounded` gives those of the paper, in 8 bits.
        """
        left, top, right, bottom = self.sensor
        shape = (bottom - top, right - left)
        texture = Speckle(SPECKLE * MILLIMETRES, seed=seed)
        reference = render(texture, self.camera, shape, levels=LEVELS, bits=16, progress=progress)
        deformed = render(
            texture, self.camera, shape, displacement=self.motion, levels=LEVELS, bits=16, progress=progress
        )
        return ImagePair(reference, deformed)
