"""Cameras as sections of TOML files: ``[camera]`` of a configuration, or a camera file."""

from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationError, field_validator

from fedic._core import BrownDistortion, FrontParallel, ImageFrame, InverseSplineDistortion, Pinhole, SplineDistortion
from fedic._internal.sections import Positive, Real, Schema, Section, config_error
from fedic._internal.types import Camera, Distortion
from fedic.errors import CameraError, ConfigError

__all__ = [
    "CAMERA_SCHEMA",
    "FrontParallelSection",
    "ImageFrameSection",
    "PinholeSection",
    "Rotation",
    "parse_camera",
]


def _rotation(value: object) -> object:
    try:
        shape = np.asarray(value, dtype=np.float64).shape
    except (TypeError, ValueError):
        shape = ()
    if shape not in ((3,), (3, 3)):
        raise ValueError("should be a rotation vector of 3 numbers (radians) or a matrix of 3 rows of 3 numbers")
    return value


Rotation: TypeAlias = Annotated[list[Any], BeforeValidator(_rotation)]
"""A rotation vector or matrix."""


class ImageFrameSection(Section):
    """``[camera]`` for a mesh drawn in pixels."""

    model: Literal["image-frame"]

    def build(self) -> Camera:
        """Make the camera."""
        return ImageFrame()


class FrontParallelSection(Section):
    """``[camera]`` for a plane parallel to the sensor."""

    model: Literal["front-parallel"]
    scale: Positive
    origin: tuple[Real, Real] = (0.0, 0.0)
    angle: Real = 0.0

    def build(self) -> Camera:
        """Make the camera."""
        return FrontParallel(self.scale, self.origin, self.angle)


class DistortionSection(Section):
    """``[camera.distortion]``: the Brown-Conrady lens."""

    model: Literal["brown"] = "brown"
    radial: tuple[Real, Real, Real] = (0.0, 0.0, 0.0)
    decentering: tuple[Real, Real] = (0.0, 0.0)
    prism: tuple[Real, Real] = (0.0, 0.0)

    def build(self) -> Distortion:
        """Make the lens."""
        return BrownDistortion(self.radial, self.decentering, self.prism)


class SplineSection(Section):
    """``[camera.distortion]``: a lens of any shape, as written by `fedic.write_camera`."""

    model: Literal["spline", "inverse-spline"]
    domain: tuple[Real, Real, Real, Real]
    coefficients: list[list[tuple[Real, Real]]]

    @field_validator("coefficients")
    @classmethod
    def _rectangular(cls, rows: list[list[tuple[float, float]]]) -> list[list[tuple[float, float]]]:
        if len({len(row) for row in rows}) != 1:
            raise ValueError("should have rows of equal length")
        if len(rows) < 4 or len(rows[0]) < 4:
            raise ValueError("should have at least 4 rows of 4 pairs, for one interval along each axis")
        return rows

    def build(self) -> Distortion:
        """Make the lens."""
        kind = SplineDistortion if self.model == "spline" else InverseSplineDistortion
        return kind(self.domain, self.coefficients)


def _lens_kind(value: object) -> str:
    if isinstance(value, dict):
        model = str(value.get("model", "brown"))
        return "spline" if model in ("spline", "inverse-spline") else model
    return "spline" if isinstance(value, SplineSection) else "brown"


LensSection: TypeAlias = Annotated[
    Annotated[DistortionSection, Tag("brown")] | Annotated[SplineSection, Tag("spline")], Discriminator(_lens_kind)
]


class PinholeSection(Section):
    """``[camera]`` for a calibrated camera."""

    model: Literal["pinhole"]
    focal: tuple[Positive, Positive]
    principal_point: tuple[Real, Real]
    rotation: Rotation = Field(default_factory=lambda: [0.0, 0.0, 0.0])
    translation: tuple[Real, Real, Real] = (0.0, 0.0, 0.0)
    skew_angle: Positive = np.pi / 2
    distortion: LensSection | None = None

    def build(self) -> Camera:
        """Make the camera."""
        lens = self.distortion
        return Pinhole(
            self.focal,
            self.principal_point,
            rotation=self.rotation,
            translation=self.translation,
            skew_angle=self.skew_angle,
            distortion=None if lens is None else lens.build(),
        )


CAMERA_SCHEMA = Schema(
    {
        "camera.image-frame": ImageFrameSection,
        "camera.front-parallel": FrontParallelSection,
        "camera.pinhole": PinholeSection,
        "camera.pinhole.distortion.brown": DistortionSection,
        "camera.pinhole.distortion.spline": SplineSection,
    },
    {
        "camera": ("image-frame", "front-parallel", "pinhole"),
        "camera.pinhole.distortion": ("brown", "spline", "inverse-spline"),
    },
)
"""The sections of a camera, for error messages."""


class _CameraAlone(Section):
    camera: Annotated[ImageFrameSection | FrontParallelSection | PinholeSection, Field(discriminator="model")]


def parse_camera(path: Path, content: dict[str, Any]) -> Camera:
    """Make the camera that the keys of ``[camera]`` describe.

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
        If the values are not those of a camera.
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
