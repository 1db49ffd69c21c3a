"""Camera files: ``camera.toml`` of fedic, and those of other programs."""

from collections.abc import Mapping
from pathlib import Path

from fedic._internal.types import Camera, StrPath
from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.formats import READERS
from fedic.cameras.files.programs.camera_toml import write_toml
from fedic.cameras.files.programs.opencv_writer import write_opencv
from fedic.errors import CameraError, FedicError, OptionError
from fedic.io.files import check_file

__all__ = ["check_writable", "read_camera", "read_file_camera", "write_camera"]

_OPENCV = (".yml", ".yaml", ".xml")


def read_camera(path: StrPath, *, number: int = 0) -> Camera:
    """Read a calibrated camera.

    Parameters
    ----------
    path : str or path
        File of fedic (``.toml``), OpenCV, ROS, Kalibr, EuRoC (``.yml``, ``.yaml``), OpenCV, DICe, VIC-3D, Metashape
        (``.xml``), VIC-3D, DICe, COLMAP (``.txt``), MatchID (``.caldat``), MATLAB (``.mat``), or arrays under OpenCV's
        usual names (``.npz``).
    number : int
        Index of the camera in a file of several, from 0.

    Returns
    -------
    Pinhole, FrontParallel or ImageFrame
        The camera with the pose in the file, and the size of its images if the file has it. Without a pose, and for
        the first of several cameras, the world is the camera's own frame: no rotation, no translation. The pose of
        another camera maps the frame of the first to its own. DICe and Anipose have poses for all in one world.

    Raises
    ------
    CameraError
        If the file is missing, truncated, lacks a value or the pose of a second camera, or has a value that fedic's
        cameras cannot represent.

    Warns
    -----
    CalibrationWarning
        If a rotation matrix has so few digits that the nearest rotation differs by more than 1e-6.
    """
    found = read_file_camera(path, number=number)
    if found.missing_pose:
        raise CameraError(f"{path}: {found.missing_pose} (Or give rotation and translation in [camera] of a run.)")
    return found.camera


def read_file_camera(path: StrPath, *, number: int = 0) -> FileCamera:
    """Read a camera whose pose may be missing; parameters and errors as `read_camera`."""
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise CameraError(f"{path}: {path.suffix!r} is not a camera format; give one of {', '.join(READERS)}.")
    check_file(path, CameraError, "camera file")
    return reader(path, number)


def write_camera(
    camera: Camera, path: StrPath, *, overwrite: bool = False, notes: Mapping[str, object] | None = None
) -> Path:
    """Write a camera.

    Parameters
    ----------
    camera : Pinhole, FrontParallel or ImageFrame
        The camera; OpenCV's files can hold a `fedic.Pinhole` without skew only.
    path : str or path
        File, ending in ``.toml`` (read by ``fedic run``), ``.yml``, ``.yaml`` or ``.xml`` (OpenCV).
    overwrite : bool
        If true, an existing file is replaced.
    notes : mapping, optional
        Numbers and texts for the section ``[calibration]`` of a ``.toml`` file, which is ignored on reading.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CameraError
        If the file exists and `overwrite` is false, or the format cannot hold the camera.
    OptionError
        If the suffix is unknown.
    FedicError
        If the file cannot be written.
    """
    path = Path(path)
    check_writable(path, overwrite=overwrite)
    if path.suffix.lower() == ".toml":
        write_toml(camera, path, notes or {})
    else:
        write_opencv(camera, path)
    return path


def check_writable(path: Path, *, overwrite: bool) -> None:
    """Check, before any long work, that a camera can be written to a file.

    Parameters
    ----------
    path : Path
        The file.
    overwrite : bool
        If true, the file may exist.

    Raises
    ------
    CameraError
        If the file exists and `overwrite` is false.
    OptionError
        If its suffix is not a format that can be written.
    FedicError
        If its folder does not exist.
    """
    if path.suffix.lower() not in (".toml", *_OPENCV):
        raise OptionError(
            f"{path}: a camera cannot be written as {path.suffix!r}; give .toml, {', '.join(_OPENCV)}.", "path"
        )
    if not path.parent.is_dir():
        raise FedicError(f"{path}: the folder {path.parent} does not exist; make it first.")
    if path.exists() and not overwrite:
        raise CameraError(
            f"{path}: this camera file exists and was not changed; overwrite=True (--overwrite) replaces it."
        )
