"""Files of OpenCV and NumPy."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from scenes.camera_files.camera_file import CameraFile
from scenes.camera_files.pair import K1, K2, K3, P1, P2, SHIFT, SIZE, K, R, truth

_CENTRE = "px, first pixel centre (0, 0); k1 k2 p1 p2 k3"
_BROWN5 = [K1, K2, P1, P2, K3]


def storage(**values: Any) -> Callable[[Path], None]:
    """Return a function that writes a file of OpenCV."""

    def write(path: Path) -> None:
        file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        for key, value in values.items():
            file.write(key, value if isinstance(value, int) else np.atleast_2d(np.asarray(value, dtype=float)))
        file.release()

    return write


FILES = [
    CameraFile(
        "OpenCV YAML",
        "a.yml",
        storage(image_width=640, image_height=480, camera_matrix=K, distortion_coefficients=_BROWN5),
        truth(k3=K3),
        _CENTRE,
        "PyYAML",
    ),
    CameraFile(
        "OpenCV XML",
        "a.xml",
        storage(image_width=640, image_height=480, camera_matrix=K, distortion_coefficients=_BROWN5),
        truth(k3=K3),
        _CENTRE,
        "defusedxml",
    ),
    CameraFile(
        "OpenCV stereo",
        "a.yml",
        storage(M1=K, D1=_BROWN5, M2=K, D2=_BROWN5, R=R, T=SHIFT),
        truth(second=True, k3=K3, size=None),
        "X_1 = R X_0 + T",
        "PyYAML",
        1,
    ),
    CameraFile(
        "OpenCV stereo without R, T",
        "a.yml",
        storage(M1=K, D1=_BROWN5, M2=K, D2=_BROWN5),
        "rotation and the translation of camera 1",
        "R, T in extrinsics.yml",
        "PyYAML",
        1,
    ),
    CameraFile(
        "OpenCV, rational model",
        "a.yml",
        storage(camera_matrix=K, D=[*_BROWN5, 0.1, 0, 0]),
        "k4 = 0.1",
        "k4 to k6 not zero",
        "PyYAML",
    ),
    CameraFile(
        "NumPy arrays",
        "a.npz",
        lambda path: np.savez(path, mtx=K, dist=_BROWN5, image_size=SIZE),
        truth(k3=K3),
        _CENTRE,
        "NumPy",
    ),
]
