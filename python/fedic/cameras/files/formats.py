"""Readers of camera files by suffix, and by what is in a file where programs share a suffix."""

from collections.abc import Callable, Mapping
from pathlib import Path

from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.programs.camera_toml import read_toml
from fedic.cameras.files.programs.dice import dice_text_camera, dice_xml_camera
from fedic.cameras.files.programs.kalibr import euroc_camera, is_camchain, is_euroc, kalibr_camera
from fedic.cameras.files.programs.matchid import read_matchid
from fedic.cameras.files.programs.matlab import read_matlab
from fedic.cameras.files.programs.opencv import opencv_camera
from fedic.cameras.files.programs.photogrammetry import colmap_camera, is_colmap, metashape_camera
from fedic.cameras.files.programs.ros import is_camera_info, ros_camera
from fedic.cameras.files.programs.vic3d import vic3d_camera
from fedic.cameras.files.programs.vic3d_project import vic3d_project_camera
from fedic.cameras.files.syntax.npz_trees import read_npz
from fedic.cameras.files.syntax.tree import LARGEST_FILE
from fedic.cameras.files.syntax.xml_trees import read_xml, xml_tree
from fedic.cameras.files.syntax.yaml_trees import read_yaml
from fedic.errors import CameraError
from fedic.io.text import read_text

__all__ = ["READERS"]


def _read_yaml(path: Path, number: int) -> FileCamera:
    """Read a YAML file of OpenCV, ROS, Kalibr or EuRoC."""
    documents = read_yaml(path)
    if not documents:
        raise CameraError(f"{path}: this file is empty; is it truncated?")
    first = documents[0]
    if is_camera_info(first):
        return ros_camera(path, documents, number)
    if len(documents) > 1 or not isinstance(first, dict):
        raise CameraError(f"{path}: this file is no camera of OpenCV, ROS, Kalibr or EuRoC: not one table of keys.")
    if is_camchain(first):
        return kalibr_camera(path, first, number)
    return euroc_camera(path, first, number) if is_euroc(first) else opencv_camera(path, first, number)


def _read_xml(path: Path, number: int) -> FileCamera:
    """Read an XML file of OpenCV, DICe, VIC-3D or Metashape."""
    root = read_xml(path)
    if root.tag == "opencv_storage":
        tree = xml_tree(path, root)
        return opencv_camera(path, tree if isinstance(tree, dict) else {}, number)
    if root.tag == "ParameterList":
        return dice_xml_camera(path, root, number)
    if root.tag in ("project", "calibration") and root.find(".//camera") is not None:
        return vic3d_project_camera(path, root, number)
    if root.tag == "calibration":
        return metashape_camera(path, root, number)
    if root.tag == "document":
        raise CameraError(
            f"{path}: this is a project of Metashape; export the calibration of one camera (Tools, Camera Calibration, "
            "Save) as Agisoft XML or OpenCV XML."
        )
    raise CameraError(
        f"{path}: the root is <{root.tag}>; fedic reads <opencv_storage> (OpenCV), <ParameterList> (DICe), <project> "
        "(VIC-3D) and <calibration> (Metashape)."
    )


def _read_text(path: Path, number: int) -> FileCamera:
    """Read a text file of VIC-3D, DICe or COLMAP."""
    text = read_text(path, LARGEST_FILE, CameraError)
    if is_colmap(text):
        return colmap_camera(path, text, number)
    first = next((words[0] for line in text.splitlines() if (words := line.split("#")[0].split())), "")
    try:
        float(first)
    except ValueError:
        return vic3d_camera(path, text, number)
    return dice_text_camera(path, text, number)


def _read_npz(path: Path, number: int) -> FileCamera:
    """Read arrays with the names of OpenCV's programs."""
    return opencv_camera(path, read_npz(path), number)


READERS: Mapping[str, Callable[[Path, int], FileCamera]] = {
    ".toml": read_toml,
    ".yml": _read_yaml,
    ".yaml": _read_yaml,
    ".xml": _read_xml,
    ".npz": _read_npz,
    ".txt": _read_text,
    ".caldat": read_matchid,
    ".mat": read_matlab,
}
"""The reader of each suffix."""
