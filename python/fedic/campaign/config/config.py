"""Configuration file of ``fedic run``."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, PrivateAttr, ValidationError, ValidationInfo

from fedic._internal.sections import InFolder, Schema, Section, config_error, in_folder
from fedic._internal.units import checked_unit
from fedic.cameras.schema import CAMERA_SCHEMA, ImageFrameSection
from fedic.campaign.campaign import Campaign
from fedic.campaign.config.camera_section import CameraFileSection, CameraSection
from fedic.campaign.config.correlation_section import CorrelationSection
from fedic.campaign.config.measurement_sections import MEASUREMENT_SECTIONS
from fedic.campaign.config.mesh_section import MeshSection
from fedic.campaign.frames.image_list import expand_names
from fedic.campaign.outputs import Outputs, result_names
from fedic.campaign.tracking import ReferenceUpdate, Starts
from fedic.errors import CameraError, ConfigError, FedicError, ImageError, MeshError, OptionError
from fedic.io.images import split_page
from fedic.io.meshes import split_choice
from fedic.io.toml import load_toml
from fedic.results import StrainMeasure

__all__ = ["Config", "load_config"]


def _expanded(value: object, info: ValidationInfo) -> object:
    """Expand a file name, a pattern, or a list of them into a list of file names."""
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise ValueError("should be a file name, a pattern such as 'frame-*.tif', or a list of them")
    if any("\0" in name for name in names):
        raise ValueError("should be names without the character NUL")
    files, left_out = expand_names(names, in_folder(Path(), info), info.data.get("reference"))
    (info.context or {}).setdefault("left_out", left_out)
    return files


def _times(value: object) -> object:
    """Check the times of the frames: where they come from, or the frames per second."""
    is_rate = isinstance(value, int | float) and not isinstance(value, bool) and 0.0 < value < float("inf")
    if value in ("modified", "recorded") or is_rate:
        return value
    raise ValueError("should be 'modified', 'recorded' or the number of frames per second")


class ImagesSection(Section):
    """``[images]``: the files."""

    reference: InFolder
    deformed: Annotated[list[InFolder], BeforeValidator(_expanded), Field(min_length=1)]


class SeriesSection(Section):
    """``[series]``: how one frame follows the other."""

    starts: Starts = "extrapolated"
    reference_update: ReferenceUpdate = "first"
    times: Annotated[Literal["modified", "recorded"] | float | None, BeforeValidator(_times)] = None


class OutputSection(Section):
    """``[output]``: where the results go, and the measure of the strains in them."""

    folder: InFolder
    strain_measure: StrainMeasure = "green-lagrange"
    files: list[Literal["vtu", "npz"]] = Field(default_factory=list)
    pictures: Annotated[bool, Field(strict=True)] = True


class Config(Section):
    """The whole file."""

    images: ImagesSection
    mesh: MeshSection
    camera: CameraSection = ImageFrameSection(model="image-frame")
    correlation: CorrelationSection = CorrelationSection()
    series: SeriesSection = SeriesSection()
    output: OutputSection
    _source: Path | None = PrivateAttr(None)
    _left_out: list[str] = PrivateAttr(default_factory=list)

    def model_post_init(self, context: dict[str, Any] | None) -> None:
        """Keep what is not in the file: its name, and the images that patterns left out."""
        self._source = (context or {}).get("source")
        self._left_out = (context or {}).get("left_out", [])

    @property
    def left_out(self) -> list[str]:
        """Files that match a pattern of ``images.deformed`` but are the reference image, which is not measured."""
        return self._left_out

    def outputs(self) -> Outputs:
        """Return the files that the run writes, which are not checked yet."""
        inputs = [("images.reference", split_page(self.images.reference)[0])]
        inputs += [("images.deformed", split_page(image)[0]) for image in self.images.deformed]
        if self.mesh.file is not None:
            inputs.append(("mesh.file", split_choice(self.mesh.file)[0]))
        if isinstance(self.camera, CameraFileSection):
            inputs.append(("camera.file", self.camera.file))
        if self._source is not None:
            inputs.append(("this configuration", self._source))
        endings = tuple(f".{name}" for name in sorted(set(self.output.files), reverse=True))
        names = result_names(self.images.deformed)
        return Outputs(self.output.folder, names, endings, self.output.pictures, inputs)

    def campaign(self, store: Path) -> Campaign:
        """Return the campaign that the file describes.

        Parameters
        ----------
        store : Path
            The file of its results.

        Returns
        -------
        Campaign
            The campaign.
        """
        section = self.series
        return Campaign(
            self.images.reference,
            self.images.deformed,
            self.mesh.build(),
            self.camera.build(),
            store=store,
            times=section.times,
            starts=section.starts,
            reference_update=section.reference_update,
            strain_measure=self.output.strain_measure,
            unit=self.mesh.unit,
            **self.correlation.options(),
        )


_SCHEMA = Schema(
    {
        "": Config,
        "images": ImagesSection,
        "series": SeriesSection,
        "output": OutputSection,
        **MEASUREMENT_SECTIONS,
    },
    CAMERA_SCHEMA.choices,
)


def load_config(path: Path) -> Config:
    """Read and check the configuration of a run; every file it names must exist.

    Parameters
    ----------
    path : Path
        The TOML file. The paths in it are relative to its folder.

    Returns
    -------
    Config
        The configuration, with paths that are absolute or relative to the current folder.

    Raises
    ------
    ConfigError
        If the file is missing, is not TOML, or has an unknown, missing or wrong key, or if a result would replace a
        file that is read.
    ImageError, MeshError, CameraError
        If an image, mesh or camera it names does not exist, or the camera cannot be read.
    """
    content = load_toml(path, ConfigError, "configuration")
    try:
        config = Config.model_validate(content, context={"folder": path.parent, "source": path})
    except ValidationError as error:
        raise config_error(path, error, _SCHEMA) from error
    _check_files(path, config)
    try:
        checked_unit(config.mesh.unit, config.camera.build())
    except OptionError as error:
        raise ConfigError(f"{path}: mesh.{error}", "mesh.unit") from error
    try:
        config.outputs().check()
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}", error.key) from error
    return config


def _check_files(path: Path, config: Config) -> None:
    for key, image in (("reference", config.images.reference), *(("deformed", d) for d in config.images.deformed)):
        _check_file(path, f"images.{key}", split_page(image)[0], ImageError)
    if config.mesh.file is not None:
        _check_file(path, "mesh.file", split_choice(config.mesh.file)[0], MeshError)
    if isinstance(config.camera, CameraFileSection):
        _check_file(path, "camera.file", config.camera.file, CameraError)


def _check_file(path: Path, key: str, file: Path, error: type[FedicError]) -> None:
    if not file.is_file():
        state = "is not a regular file" if file.exists() else "does not exist"
        raise error(f"{path}: {key} names {file}, which {state}.")
