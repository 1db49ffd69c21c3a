"""The TOML file of ``fedic run``: its keys, their checks, and messages that name the key at fault."""

import difflib
import glob
import sys
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import ErrorDetails

from fedic._core import (
    BrownDistortion,
    FrontParallel,
    ImageFrame,
    InverseSplineDistortion,
    Mesh,
    Pinhole,
    SplineDistortion,
    rectangle_mesh,
)
from fedic._internal.types import Camera, CellName, Distortion
from fedic.cameras.files import read_camera
from fedic.cameras.poses import posed
from fedic.errors import CameraError, ConfigError, ImageError, MeshError
from fedic.io.meshes import read_mesh
from fedic.meshing import unstructured_mesh
from fedic.quadrature import MeshQuadrature, PixelQuadrature, Quadrature

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

__all__ = ["Config", "load_config", "parse_camera", "read_tables"]


def _in_folder(path: Path, info: ValidationInfo) -> Path:
    return Path((info.context or {}).get("folder", "."), path)


def _expanded(value: object, info: ValidationInfo) -> object:
    """Make one list of file names out of a name, a pattern, or a list of them."""
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise ValueError("should be a file name, a pattern such as 'frame-*.tif', or a list of them")
    folder = _in_folder(Path(), info)
    files: list[str] = []
    for name in names:
        if not glob.has_magic(name) or _in_folder(Path(name), info).exists():
            files.append(name)
            continue
        matches = sorted(glob.glob(name, root_dir=folder))  # noqa: PTH207 - the pattern may be absolute
        if not matches:
            raise ValueError(f"should match some file: {name!r} matches none in {folder}")
        files += matches
    return files


def _rotation(value: object) -> object:
    try:
        shape = np.asarray(value, dtype=np.float64).shape
    except (TypeError, ValueError):
        shape = ()
    if shape not in ((3,), (3, 3)):
        raise ValueError("should be a rotation vector of 3 numbers (radians) or a matrix of 3 rows of 3 numbers")
    return value


Real: TypeAlias = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive: TypeAlias = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0.0)]
NotNegative: TypeAlias = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0)]
Count: TypeAlias = Annotated[int, Field(strict=True, ge=1)]
InFolder: TypeAlias = Annotated[Path, AfterValidator(_in_folder)]
Polygon: TypeAlias = Annotated[list[tuple[Real, Real]], Field(min_length=3)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ImagesSection(_Section):
    """``[images]``: the files."""

    reference: InFolder
    deformed: Annotated[list[InFolder], BeforeValidator(_expanded), Field(min_length=1)]


class RectangleSection(_Section):
    """``[mesh.rectangle]``: a regular mesh."""

    bounds: tuple[Real, Real, Real, Real]
    size: Positive = 20.0
    cell: CellName = "quad"


class UnstructuredSection(_Section):
    """``[mesh.unstructured]``: a polygon with holes, meshed by Gmsh."""

    outline: Polygon
    holes: list[Polygon] = []
    size: Positive = 20.0
    cell: CellName = "triangle"


class MeshSection(_Section):
    """``[mesh]``: a file, or one of the two generators."""

    file: InFolder | None = None
    rectangle: RectangleSection | None = None
    unstructured: UnstructuredSection | None = None

    @model_validator(mode="after")
    def _one_source(self) -> "MeshSection":
        if len(self.model_fields_set) != 1:
            raise ValueError("should hold exactly one of mesh.file, [mesh.rectangle] and [mesh.unstructured]")
        return self

    def build(self) -> Mesh:
        """Read or make the mesh."""
        if self.file is not None:
            return read_mesh(self.file)
        if self.rectangle is not None:
            return rectangle_mesh(self.rectangle.bounds, size=self.rectangle.size, cell=self.rectangle.cell)
        assert self.unstructured is not None
        plan = self.unstructured
        return unstructured_mesh(plan.outline, size=plan.size, cell=plan.cell, holes=plan.holes)


class ImageFrameSection(_Section):
    """``[camera]`` for a mesh drawn in pixels."""

    model: Literal["image-frame"]

    def build(self) -> Camera:
        """Make the camera."""
        return ImageFrame()


class FrontParallelSection(_Section):
    """``[camera]`` for a plane parallel to the sensor."""

    model: Literal["front-parallel"]
    scale: Positive
    origin: tuple[Real, Real] = (0.0, 0.0)
    angle: Real = 0.0

    def build(self) -> Camera:
        """Make the camera."""
        return FrontParallel(self.scale, self.origin, self.angle)


class DistortionSection(_Section):
    """``[camera.distortion]``: the Brown-Conrady lens."""

    model: Literal["brown"] = "brown"
    radial: tuple[Real, Real, Real] = (0.0, 0.0, 0.0)
    decentering: tuple[Real, Real] = (0.0, 0.0)
    prism: tuple[Real, Real] = (0.0, 0.0)

    def build(self) -> Distortion:
        """Make the lens."""
        return BrownDistortion(self.radial, self.decentering, self.prism)


class SplineSection(_Section):
    """``[camera.distortion]``: a lens of any shape, as `fedic.write_camera` writes it."""

    model: Literal["spline", "inverse-spline"]
    domain: tuple[Real, Real, Real, Real]
    coefficients: list[list[tuple[Real, Real]]]

    @field_validator("coefficients")
    @classmethod
    def _rectangular(cls, rows: list[list[tuple[float, float]]]) -> list[list[tuple[float, float]]]:
        if len({len(row) for row in rows}) != 1:
            raise ValueError("should have rows of one length")
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


class PinholeSection(_Section):
    """``[camera]`` for a calibrated camera."""

    model: Literal["pinhole"]
    focal: tuple[Positive, Positive]
    principal_point: tuple[Real, Real]
    rotation: Annotated[list[Any], BeforeValidator(_rotation)] = [0.0, 0.0, 0.0]
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


class CameraFileSection(_Section):
    """``[camera]`` in a file of its own, fedic's or another package's; a pose given here takes the place of its own."""

    file: InFolder
    number: Annotated[int, Field(strict=True, ge=0)] = 0
    rotation: Annotated[list[Any] | None, BeforeValidator(_rotation)] = None
    translation: tuple[Real, Real, Real] | None = None

    def build(self) -> Camera:
        """Read the camera."""
        camera = read_camera(self.file, number=self.number)
        if self.rotation is None and self.translation is None:
            return camera
        if not isinstance(camera, Pinhole):
            raise CameraError(
                f"{self.file}: a {type(camera).__name__} has no pose; leave out rotation and translation."
            )
        return posed(
            camera,
            camera.rotation if self.rotation is None else np.asarray(self.rotation, dtype=np.float64),
            np.asarray(camera.translation if self.translation is None else self.translation),
        )


class CorrelationSection(_Section):
    """``[correlation]``: the options of `fedic.correlate`."""

    quadrature: Literal["rotated", "edges", "diameter", "pixel"] = "rotated"
    density: Positive = 1.0
    interpolation: Literal["bilinear", "bicubic", "bspline3", "bspline5"] = "bspline5"
    gradient: Literal["analytic", "finite-difference"] = "analytic"
    smoothing: NotNegative = 0.8
    brightness: Literal["global", "element", "none"] = "global"
    hessian: Literal["initial", "updated"] = "initial"
    initial: Literal["none", "pyramid", "fft"] = "none"
    regularization_length: Positive | None = None
    tolerance: Positive = 1e-3
    max_iterations: Count = 50
    num_threads: Count | None = None

    def options(self) -> dict[str, Any]:
        """Return the keyword arguments of `fedic.Correlator`."""
        options = self.model_dump(exclude={"quadrature", "density"})
        options["quadrature"] = self._quadrature()
        options["brightness"] = None if self.brightness == "none" else self.brightness
        options["initial"] = None if self.initial == "none" else self.initial
        return options

    def _quadrature(self) -> Quadrature:
        if self.quadrature == "pixel":
            return PixelQuadrature()
        return MeshQuadrature(density=self.density, rule=self.quadrature)


class OutputSection(_Section):
    """``[output]``: where the results go."""

    folder: InFolder
    pictures: Annotated[bool, Field(strict=True)] = True


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


class Config(_Section):
    """The whole file."""

    images: ImagesSection
    mesh: MeshSection
    camera: CameraSection = ImageFrameSection(model="image-frame")
    correlation: CorrelationSection = CorrelationSection()
    output: OutputSection


class _CameraAlone(_Section):
    camera: CameraSection


_SECTIONS: dict[str, type[_Section]] = {
    "": Config,
    "images": ImagesSection,
    "mesh": MeshSection,
    "mesh.rectangle": RectangleSection,
    "mesh.unstructured": UnstructuredSection,
    "camera.image-frame": ImageFrameSection,
    "camera.front-parallel": FrontParallelSection,
    "camera.pinhole": PinholeSection,
    "camera.pinhole.distortion.brown": DistortionSection,
    "camera.pinhole.distortion.spline": SplineSection,
    "camera.file": CameraFileSection,
    "correlation": CorrelationSection,
    "output": OutputSection,
}
_CAMERA_MODELS = ("image-frame", "front-parallel", "pinhole")
_LENS_MODELS = ("brown", "spline", "inverse-spline")


def load_config(path: Path) -> Config:
    """Read and check the configuration of a run; every file it names must exist.

    Parameters
    ----------
    path : Path
        The TOML file. The paths in it are relative to its folder.

    Returns
    -------
    Config
        With absolute or current-folder-relative paths.

    Raises
    ------
    ConfigError
        If the file is missing, is not TOML, or has an unknown, missing or wrong key.
    ImageError, MeshError, CameraError
        If an image, mesh or camera it names does not exist, or that camera cannot be read.
    """
    content = read_tables(path, "configuration")
    try:
        config = Config.model_validate(content, context={"folder": path.parent})
    except ValidationError as error:
        raise _config_error(path, error) from error
    _check_files(path, config)
    return config


def read_tables(path: Path, what: str) -> dict[str, Any]:
    """Read a TOML file.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        How messages call it, such as ``"configuration"``.

    Returns
    -------
    dict
        Its tables.

    Raises
    ------
    ConfigError
        If the file is missing or is not TOML.
    """
    try:
        tables: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ConfigError(f"{path}: there is no such {what} file; check the path.") from None
    except OSError as error:
        raise ConfigError(f"{path}: the {what} file cannot be read ({error.strerror}).") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: the {what} file is not UTF-8 text.") from error
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{path}: not a valid TOML file: {error}.") from error
    return tables


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
        If the values make no camera.
    """
    try:
        section = _CameraAlone.model_validate({"camera": content}, context={"folder": path.parent}).camera
    except ValidationError as error:
        raise _config_error(path, error, within="camera.") from error
    if isinstance(section, CameraFileSection):
        raise ConfigError(f"{path}: file names another camera file; this file should hold the camera itself.", "file")
    try:
        return section.build()
    except CameraError as error:
        raise CameraError(f"{path}: {error}") from error


def _check_files(path: Path, config: Config) -> None:
    for key, image in (("reference", config.images.reference), *(("deformed", d) for d in config.images.deformed)):
        if not image.is_file():
            raise ImageError(f"{path}: images.{key} names {image}, which does not exist.")
    mesh = config.mesh.file
    if mesh is not None and not mesh.is_file():
        raise MeshError(f"{path}: mesh.file names {mesh}, which does not exist.")
    if isinstance(config.camera, CameraFileSection):
        if not config.camera.file.is_file():
            raise CameraError(f"{path}: camera.file names {config.camera.file}, which does not exist.")
        config.camera.build()
    stems = [image.stem for image in config.images.deformed]
    twice = next((stem for stem in stems if stems.count(stem) > 1), None)
    if twice is not None:
        raise ConfigError(
            f"{path}: images.deformed names two images called {twice!r}; their results would overwrite each other.",
            "images.deformed",
        )


def _config_error(path: Path, error: ValidationError, within: str = "") -> ConfigError:
    details = error.errors(include_url=False)
    details.sort(key=lambda detail: detail["type"] != "extra_forbidden")  # a misspelt key is why another is missing
    faults = [(key.removeprefix(within), what) for key, what in map(_fault, details)]
    return ConfigError(f"{path}: " + "\n".join(f"{key} {what}" for key, what in faults), faults[0][0])


def _fault(details: ErrorDetails) -> tuple[str, str]:
    """Return the dotted key at fault and what is wrong with it."""
    location = details["loc"]
    key = _dotted(location)
    kind = details["type"]
    if kind == "extra_forbidden":
        return key, f"is not a known key; {_suggestion(location)}"
    if kind == "missing":
        return key, "is missing."
    if kind == "union_tag_not_found":
        return f"{key}.model", f"is missing; choose one of {', '.join(_CAMERA_MODELS)}."
    if kind == "union_tag_invalid":
        given = details["input"]["model"]
        models = _LENS_MODELS if location[-1] == "distortion" else _CAMERA_MODELS
        return f"{key}.model", f"= {given!r} is unknown; choose one of {', '.join(models)}."
    if kind == "path_type":
        return key, f"= {_short(details['input'])} should be the name of a file or folder."
    expected = details["msg"].removeprefix("Value error, ").removeprefix("Input ")
    if isinstance(details["input"], dict):
        return key, f"{expected}."
    return key, f"= {_short(details['input'])} {expected}."


def _dotted(location: tuple[int | str, ...]) -> str:
    """Write a location as in the file: without the tags pydantic inserts, indices in brackets."""
    parts = [part for index, part in enumerate(location) if not _is_tag(location, index)]
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in parts).removeprefix(".")


def _is_tag(location: tuple[int | str, ...], index: int) -> bool:
    if index == 1:
        return location[0] == "camera" and location[1] in (*_CAMERA_MODELS, "file")
    return location[:3] == ("camera", "pinhole", "distortion") and index == 3


def _suggestion(location: tuple[int | str, ...]) -> str:
    *section, name = (str(part) for part in location)
    known = list(_SECTIONS[".".join(section)].model_fields)
    nearest = difflib.get_close_matches(name, known, n=1)
    return f'did you mean "{nearest[0]}"?' if nearest else f"the keys here are {', '.join(known)}."


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
