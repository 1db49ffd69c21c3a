"""Types of the extension module: the Rust core as Python sees it."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "BrownDistortion",
    "Correlator",
    "FrontParallel",
    "ImageFrame",
    "Mesh",
    "Pinhole",
    "SelfCalibration",
    "Solution",
    "Speckle",
    "__version__",
    "aperture_points",
    "calibrate_on_specimen",
    "interpolate_image",
    "rectangle_mesh",
]

__version__: str

_CellName = Literal["triangle", "triangle6", "quad", "quad8", "quad9"]
_Image = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.float32]

@final
class Mesh:
    def __new__(cls, points: ArrayLike, cells: Mapping[str, ArrayLike]) -> Mesh: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def cells(self) -> dict[str, NDArray[np.int64]]: ...
    @property
    def num_cells(self) -> int: ...
    @property
    def num_nodes(self) -> int: ...
    @property
    def used_nodes(self) -> NDArray[np.bool_]: ...
    @property
    def flipped_cells(self) -> NDArray[np.int64]: ...
    def areas(self) -> NDArray[np.float64]: ...
    def outlines(self) -> list[NDArray[np.int64]]: ...
    def strains(self, displacement: ArrayLike) -> NDArray[np.float64]: ...
    def interpolate(self, nodal: ArrayLike, points: ArrayLike) -> NDArray[np.float64]: ...

def rectangle_mesh(bounds: tuple[float, float, float, float], size: float = 20.0, cell: _CellName = "quad") -> Mesh: ...

@final
class BrownDistortion:
    def __new__(
        cls,
        radial: tuple[float, float, float] = (0.0, 0.0, 0.0),
        decentering: tuple[float, float] = (0.0, 0.0),
        prism: tuple[float, float] = (0.0, 0.0),
    ) -> BrownDistortion: ...
    @property
    def radial(self) -> tuple[float, float, float]: ...
    @property
    def decentering(self) -> tuple[float, float]: ...
    @property
    def prism(self) -> tuple[float, float]: ...

@final
class ImageFrame:
    def __new__(cls) -> ImageFrame: ...
    def project(self, points: ArrayLike) -> NDArray[np.float64]: ...
    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]: ...
    def unproject(self, pixels: ArrayLike, z: float = 0.0) -> NDArray[np.float64]: ...

@final
class FrontParallel:
    def __new__(cls, scale: float, origin: tuple[float, float] = (0.0, 0.0)) -> FrontParallel: ...
    @property
    def scale(self) -> float: ...
    @property
    def origin(self) -> tuple[float, float]: ...
    def project(self, points: ArrayLike) -> NDArray[np.float64]: ...
    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]: ...
    def unproject(self, pixels: ArrayLike, z: float = 0.0) -> NDArray[np.float64]: ...

@final
class Pinhole:
    def __new__(
        cls,
        focal: tuple[float, float],
        principal_point: tuple[float, float],
        rotation: ArrayLike | None = None,
        translation: tuple[float, float, float] = (0.0, 0.0, 0.0),
        skew_angle: float = 1.5707963267948966,
        distortion: BrownDistortion | None = None,
    ) -> Pinhole: ...
    @property
    def focal(self) -> tuple[float, float]: ...
    @property
    def principal_point(self) -> tuple[float, float]: ...
    @property
    def rotation(self) -> NDArray[np.float64]: ...
    @property
    def translation(self) -> tuple[float, float, float]: ...
    @property
    def skew_angle(self) -> float: ...
    @property
    def distortion(self) -> BrownDistortion | None: ...
    def project(self, points: ArrayLike) -> NDArray[np.float64]: ...
    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]: ...
    def unproject(self, pixels: ArrayLike, z: float = 0.0) -> NDArray[np.float64]: ...

_Camera = ImageFrame | FrontParallel | Pinhole

def aperture_points(
    camera: _Camera, rows: tuple[int, int], width: int, supersampling: int, z: float = 0.0
) -> NDArray[np.float64]: ...

@final
class Correlator:
    def __new__(
        cls,
        reference: _Image,
        mesh: Mesh,
        camera: _Camera,
        *,
        rule: Literal["rotated", "edges", "diameter", "pixel"] = "rotated",
        density: float = 1.0,
        interpolation: Literal["bilinear", "bicubic", "bspline3", "bspline5"] = "bspline5",
        gradient: Literal["analytic", "finite-difference"] = "analytic",
        prefilter: float = 0.8,
        brightness: Literal["global", "element"] | None = "global",
        hessian: Literal["initial", "updated"] = "initial",
        regularization: float | None = None,
        tolerance: float = 1e-3,
        max_iterations: int = 50,
        num_threads: int | None = None,
        progress: Callable[[str, int, int, float, float], Any] | None = None,
    ) -> Correlator: ...
    @property
    def num_points(self) -> int: ...
    def quadrature_points(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]: ...
    def correlate(
        self,
        deformed: _Image,
        *,
        initial: NDArray[np.float64] | None = None,
        pyramid: _Image | None = None,
        progress: Callable[[str, int, int, float, float], Any] | None = None,
    ) -> Solution: ...
    def residual_map(self, reference: _Image, deformed: _Image, displacement: ArrayLike) -> NDArray[np.float32]: ...
    def standard_deviations(self, reference: _Image, noise: float) -> NDArray[np.float64]: ...

@final
class Solution:
    @property
    def displacement(self) -> NDArray[np.float64]: ...
    @property
    def pixel_displacement(self) -> NDArray[np.float64]: ...
    @property
    def converged(self) -> bool: ...
    @property
    def iterations(self) -> int: ...
    @property
    def history(self) -> list[tuple[int, int, float, float]]: ...
    @property
    def residual_std(self) -> float: ...
    @property
    def cell_residuals(self) -> NDArray[np.float64]: ...
    @property
    def outside_cells(self) -> NDArray[np.int64]: ...
    @property
    def num_points(self) -> int: ...

@final
class SelfCalibration:
    @property
    def camera(self) -> Pinhole: ...
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @property
    def sensitivities(self) -> NDArray[np.float64]: ...
    @property
    def motions(self) -> NDArray[np.float64]: ...
    @property
    def motion_deviations(self) -> NDArray[np.float64]: ...
    @property
    def history(self) -> list[tuple[int, int, float, float]]: ...
    @property
    def converged(self) -> bool: ...
    @property
    def residual_std(self) -> float: ...
    @property
    def noise(self) -> float: ...
    @property
    def num_points(self) -> int: ...

def calibrate_on_specimen(
    images: Sequence[_Image],
    mesh: Mesh,
    camera: Pinhole,
    parameters: Sequence[str],
    translations: ArrayLike,
    *,
    motion: Literal["translation", "in-plane", "spatial"] = "in-plane",
    known_translations: bool = False,
    density: float = 1.0,
    interpolation: Literal["bilinear", "bicubic", "bspline3", "bspline5"] = "bspline5",
    prefilter: float = 0.8,
    brightness: bool = True,
    noise: float | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 50,
    num_threads: int | None = None,
    progress: Callable[[str, int, int, float, float], Any] | None = None,
) -> SelfCalibration: ...

@final
class Speckle:
    def __new__(cls, size: float, *, coverage: float = 0.5, seed: int = 0) -> Speckle: ...
    @property
    def size(self) -> float: ...
    @property
    def coverage(self) -> float: ...
    @property
    def seed(self) -> int: ...
    def values(self, points: ArrayLike) -> NDArray[np.float64]: ...

def interpolate_image(
    image: _Image,
    pixels: ArrayLike,
    interpolation: Literal["bilinear", "bicubic", "bspline3", "bspline5"] = "bspline3",
    prefilter: float = 0.0,
    gradient: Literal["analytic", "finite-difference"] = "analytic",
) -> tuple[NDArray[np.float32], NDArray[np.float32]]: ...
