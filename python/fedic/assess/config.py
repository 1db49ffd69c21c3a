"""Configuration file of ``fedic assess``."""

from pathlib import Path
from typing import Annotated

from pydantic import BeforeValidator, Field, ValidationError, ValidationInfo

from fedic._internal.sections import InFolder, Positive, Real, Schema, Section, config_error, in_folder
from fedic._internal.units import checked_unit
from fedic.cameras.schema import CAMERA_SCHEMA, ImageFrameSection
from fedic.campaign.config.camera_section import CameraSection
from fedic.campaign.config.correlation_section import CorrelationSection
from fedic.campaign.config.measurement_sections import MEASUREMENT_SECTIONS
from fedic.campaign.config.mesh_section import MeshSection
from fedic.campaign.frames.image_list import expand_names
from fedic.errors import ConfigError, ImageError, OptionError
from fedic.io.images import split_page
from fedic.io.toml import load_toml

__all__ = ["AssessConfig", "load_assess_config"]


def _expanded(value: object, info: ValidationInfo) -> object:
    """Expand a file name, a pattern, or a list of them into a list of file names."""
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not all(isinstance(name, str) and "\0" not in name for name in names):
        raise ValueError("should be a file name, a pattern such as 'pose1-*.tif', or a list of them")
    return expand_names(names, in_folder(Path(), info), None)[0]


class ReferenceSection(Section):
    """``[images]``: the reference image."""

    reference: InFolder


class PoseSection(Section):
    """``[[poses]]``: images of one position of the specimen, and the motion that was set."""

    images: Annotated[list[InFolder], BeforeValidator(_expanded), Field(min_length=1)]
    name: str | None = None
    displacement: tuple[Real, Real] | None = None
    rotation: Real | None = None


class AssessmentSection(Section):
    """``[assessment]``: the squares, and where the set displacements come from."""

    square: Positive
    set_uncertainty: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0)] = 0.0
    traceability: str = ""


class LimitsSection(Section):
    """``[limits]``: the largest values allowed."""

    zd: Positive | None = None
    zs: Positive | None = None
    d: Positive | None = None
    rotation: Positive | None = None

    def given(self) -> dict[str, float]:
        """Return the limits that are set."""
        return {name: limit for name, limit in self.model_dump().items() if limit is not None}


class AssessConfig(Section):
    """The whole file."""

    images: ReferenceSection
    poses: Annotated[list[PoseSection], Field(min_length=1)]
    mesh: MeshSection
    camera: CameraSection = ImageFrameSection(model="image-frame")
    correlation: CorrelationSection = CorrelationSection()
    assessment: AssessmentSection
    limits: LimitsSection = LimitsSection()


_SCHEMA = Schema(
    {
        "": AssessConfig,
        "images": ReferenceSection,
        "poses": PoseSection,
        "assessment": AssessmentSection,
        "limits": LimitsSection,
        **MEASUREMENT_SECTIONS,
    },
    CAMERA_SCHEMA.choices,
)


def load_assess_config(path: Path) -> AssessConfig:
    """Read and check the configuration of an assessment; every image it names must exist.

    Parameters
    ----------
    path : Path
        The TOML file. The paths in it are relative to its folder.

    Returns
    -------
    AssessConfig
        The configuration.

    Raises
    ------
    ConfigError
        If the file is missing, is not TOML, or has an unknown, missing or wrong key.
    ImageError, CameraError
        If an image does not exist, or the camera cannot be read.
    """
    content = load_toml(path, ConfigError, "configuration")
    try:
        config = AssessConfig.model_validate(content, context={"folder": path.parent})
    except ValidationError as error:
        raise config_error(path, error, _SCHEMA) from error
    named = [("images.reference", config.images.reference)]
    named += [(f"poses[{index}].images", image) for index, pose in enumerate(config.poses) for image in pose.images]
    for key, image in named:
        file = split_page(image)[0]
        if not file.is_file():
            state = "is not a regular file" if file.exists() else "does not exist"
            raise ImageError(f"{path}: {key} names {file}, which {state}.")
    try:
        checked_unit(config.mesh.unit, config.camera.build())
    except OptionError as error:
        raise ConfigError(f"{path}: mesh.{error}", "mesh.unit") from error
    return config
