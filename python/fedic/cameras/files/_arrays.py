"""Cameras in ``.npz`` files of OpenCV's matrices."""

import zipfile
from pathlib import Path

import numpy as np

from fedic._core import Pinhole
from fedic.cameras.files._opencv import find_key
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.errors import CameraError

__all__ = ["read_arrays"]


def read_arrays(path: Path, number: int) -> Pinhole:
    """Read a camera from arrays under OpenCV's usual names."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            keys = find_key(path, list(arrays.files), number)
            found = {what: (key, arrays[key]) for what, key in keys.items()}
    except (OSError, EOFError, ValueError, zipfile.BadZipFile) as error:
        raise CameraError(f"{path}: NumPy cannot read this file: truncated, or of another format ({error}).") from error
    return camera_from_matrices(
        path, found["matrix"], found.get("distortion"), found.get("rotation"), found.get("translation")
    )
