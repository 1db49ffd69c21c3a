"""The section ``[camera]`` of a configuration file: a camera written there, or a camera file."""

from typing import Annotated, TypeAlias

import numpy as np
from pydantic import Discriminator, Field, Tag

from fedic._core import Pinhole
from fedic._internal.sections import InFolder, Real, Section
from fedic._internal.types import Camera
from fedic.cameras.files import read_camera, read_file_camera
from fedic.cameras.poses import with_pose
from fedic.cameras.schema import (
    FrontParallelSection,
    ImageFrameSection,
    PinholeSection,
    PixelCount,
    PixelIndex,
    Rotation,
    rotation_argument,
)
from fedic.errors import CameraError

__all__ = ["CameraFileSection", "CameraSection"]


class CameraFileSection(Section):
    """``[camera]`` from a camera file; a pose given here replaces that of the file.

    The images are a region of the calibrated ones (``crop``: left, top, width, height), or binned after that.
    """

    file: InFolder
    number: Annotated[int, Field(strict=True, ge=0)] = 0
    rotation: Rotation | None = None
    translation: tuple[Real, Real, Real] | None = None
    crop: tuple[PixelIndex, PixelIndex, PixelCount, PixelCount] | None = None
    binning: PixelCount = 1

    def build(self) -> Camera:
        """Read the camera."""
        camera = self._placed()
        try:
            region = camera if self.crop is None else camera.cropped(*self.crop)
            return region if self.binning == 1 else region.binned(self.binning)
        except CameraError as error:
            raise CameraError(f"{self.file}: crop and binning in [camera]: {error}.") from None

    def _placed(self) -> Camera:
        """Read the camera, with the pose of the section."""
        posed = self.rotation is not None and self.translation is not None
        camera = (
            read_file_camera(self.file, number=self.number).camera
            if posed
            else read_camera(self.file, number=self.number)
        )
        if self.rotation is None and self.translation is None:
            return camera
        if not isinstance(camera, Pinhole):
            raise CameraError(
                f"{self.file}: a {type(camera).__name__} has no pose; leave out rotation and translation."
            )
        return with_pose(
            camera,
            camera.rotation if self.rotation is None else rotation_argument("camera.rotation", self.rotation),
            np.asarray(camera.translation if self.translation is None else self.translation),
        )


def _camera_kind(value: object) -> str | None:
    if isinstance(value, dict):
        return "file" if "file" in value else (str(value["model"]) if "model" in value else None)
    return getattr(value, "model", "file")


CameraSection: TypeAlias = Annotated[
    Annotated[ImageFrameSection, Tag("image-frame")]
    | Annotated[FrontParallelSection, Tag("front-parallel")]
    | Annotated[PinholeSection, Tag("pinhole")]
    | Annotated[CameraFileSection, Tag("file")],
    Discriminator(_camera_kind),
]
