"""Cameras as sections of TOML files: ``[camera]`` of a configuration, or a camera file."""

from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError

from fedic._core import FrontParallel, ImageFrame, Pinhole
from fedic._internal.sections import Positive, Real, Schema, Section, config_error
from fedic._internal.types import Camera, Floats
from fedic.cameras.lens_sections import LENS_SECTIONS, LensSection
from fedic.cameras.rotations import nearest_rotation
from fedic.errors import CameraError, ConfigError

__all__ = [
    "CAMERA_SCHEMA",
    "FrontParallelSection",
    "ImageFrameSection",
    "PinholeSection",
    "PixelCount",
    "PixelIndex",
    "Rotation",
    "parse_camera",
    "rotation_argument",
]


def _rotation(value: object) -> object:
    try:
        shape = np.asarray(value, dtype=np.float64).shape
    except (TypeError, ValueError, OverflowError):
        shape = ()
    if shape not in ((3,), (3, 3)):
        raise ValueError("should be a rotation vector of 3 numbers (radians) or a matrix of 3 rows of 3 numbers")
    return value


Rotation: TypeAlias = Annotated[list[Any], BeforeValidator(_rotation)]
"""A rotation vector or matrix."""
PixelCount: TypeAlias = Annotated[int, Field(strict=True, ge=1, lt=2**32)]
"""A number of pixels."""
PixelIndex: TypeAlias = Annotated[int, Field(strict=True, ge=0, lt=2**32)]
"""A column or row of an image."""
ImageSize: TypeAlias = tuple[PixelCount, PixelCount] | None
"""Width and height of the images of a camera, if known."""


def rotation_argument(where: str, rotation: list[Any]) -> Floats:
    """Return a rotation vector, or the rotation nearest to a matrix, see `nearest_rotation`."""
    values = np.asarray(rotation, dtype=np.float64)
    return values if values.ndim == 1 else nearest_rotation(where, values)


class ImageFrameSection(Section):
    """``[camera]`` for a mesh drawn in pixels."""

    model: Literal["image-frame"]
    origin: tuple[Real, Real] = (0.0, 0.0)
    scale: Positive = 1.0
    image_size: ImageSize = None

    def build(self) -> Camera:
        """Create the camera."""
        return ImageFrame(self.origin, self.scale, self.image_size)


class FrontParallelSection(Section):
    """``[camera]`` for a plane parallel to the sensor."""

    model: Literal["front-parallel"]
    scale: Positive
    origin: tuple[Real, Real] = (0.0, 0.0)
    angle: Real = 0.0
    image_size: ImageSize = None

    def build(self) -> Camera:
        """Create the camera."""
        return FrontParallel(self.scale, self.origin, self.angle, self.image_size)


class PinholeSection(Section):
    """``[camera]`` for a calibrated camera."""

    model: Literal["pinhole"]
    focal: tuple[Positive, Positive]
    principal_point: tuple[Real, Real]
    rotation: Rotation = Field(default_factory=lambda: [0.0, 0.0, 0.0])
    translation: tuple[Real, Real, Real] = (0.0, 0.0, 0.0)
    skew_angle: Positive = np.pi / 2
    distortion: LensSection | None = None
    image_size: ImageSize = None

    def build(self) -> Camera:
        """Create the camera."""
        lens = self.distortion
        return Pinhole(
            self.focal,
            self.principal_point,
            rotation=rotation_argument("the rotation of the camera", self.rotation),
            translation=self.translation,
            skew_angle=self.skew_angle,
            distortion=None if lens is None else lens.build(),
            image_size=self.image_size,
        )


CAMERA_SCHEMA = Schema(
    {
        "camera.image-frame": ImageFrameSection,
        "camera.front-parallel": FrontParallelSection,
        "camera.pinhole": PinholeSection,
        **{f"camera.pinhole.distortion.{name}": section for name, section in LENS_SECTIONS.items()},
    },
    {
        "camera": ("image-frame", "front-parallel", "pinhole"),
        "camera.pinhole.distortion": tuple(LENS_SECTIONS),
    },
)
"""The sections of a camera, for error messages."""


class _CameraAlone(Section):
    camera: Annotated[ImageFrameSection | FrontParallelSection | PinholeSection, Field(discriminator="model")]


def parse_camera(path: Path, content: dict[str, Any]) -> Camera:
    """Create the camera that the keys of ``[camera]`` describe.

    Parameters
    ----------
    path : Path
        The file they come from, for messages.
    content : dict
        The keys.

    Returns
    -------
    ImageFrame, FrontParallel or Pinhole
        The camera.

    Raises
    ------
    ConfigError
        If a key is unknown, missing or wrong.
    CameraError
        If the values are not valid for a camera.
    """
    if "file" in content:
        raise ConfigError(f"{path}: file names another camera file; this file should hold the camera itself.", "file")
    try:
        section = _CameraAlone.model_validate({"camera": content}, context={"folder": path.parent}).camera
    except ValidationError as error:
        raise config_error(path, error, CAMERA_SCHEMA, within="camera.") from error
    try:
        return section.build()
    except CameraError as error:
        raise CameraError(f"{path}: {error}") from error
