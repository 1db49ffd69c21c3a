"""Camera files: ``camera.toml`` of fedic, and those of other programs."""

from collections.abc import Callable, Mapping
from pathlib import Path

from fedic._internal.types import Camera, StrPath
from fedic.cameras.files._arrays import read_arrays
from fedic.cameras.files._matchid import read_matchid
from fedic.cameras.files._opencv import read_opencv, write_opencv
from fedic.cameras.files._toml import read_toml, write_toml
from fedic.cameras.files._vic3d import read_vic3d
from fedic.errors import CameraError, FedicError, OptionError

__all__ = ["check_writable", "read_camera", "write_camera"]

_READERS: dict[str, Callable[[Path, int], Camera]] = {
    ".toml": read_toml,
    ".yml": read_opencv,
    ".yaml": read_opencv,
    ".xml": read_opencv,
    ".npz": read_arrays,
    ".txt": read_vic3d,
    ".caldat": read_matchid,
}
_OPENCV = (".yml", ".yaml", ".xml")


def read_camera(path: StrPath, *, number: int = 0) -> Camera:
    """Read a calibrated camera.

    Parameters
    ----------
    path : str or path
        File; its suffix is the format: ``.toml`` (fedic), ``.yml``, ``.yaml`` or ``.xml`` (OpenCV), ``.npz`` (arrays
        under OpenCV's usual names), ``.txt`` (report of VIC-3D), ``.caldat`` (MatchID).
    number : int
        Index of the camera in a file of two: 0 or 1.

    Returns
    -------
    Pinhole, FrontParallel or ImageFrame
        The camera with the pose in the file. Without a pose, and for the first of two cameras, the world is the
        camera's own frame: no rotation, no translation. The pose of the second of two cameras maps the frame of the
        first to its own.

    Raises
    ------
    CameraError
        If the file is missing, truncated, lacks a value, or has a value that fedic's cameras cannot represent.
    """
    path = Path(path)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise CameraError(f"{path}: {path.suffix!r} is not a camera format; give one of {', '.join(_READERS)}.")
    if not path.is_file():
        raise CameraError(f"{path}: there is no such camera file; check the path.")
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
