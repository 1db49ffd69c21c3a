"""Files of MATLAB."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from scenes.camera_files.camera_file import CameraFile
from scenes.camera_files.pair import CX, CY, FX, FY, K1, K2, K3, P1, P2, SHIFT, R, truth

_MATLAB = "px, first pixel (1, 1): 1 subtracted; matrices transposed (K is not); k1 k2 k3, p1 p2"


def matlab_struct(*, with_k: bool = False) -> dict[str, Any]:
    """Return what ``toStruct(cameraParameters)`` holds: points are rows, the first pixel is (1, 1)."""
    matrix = np.array([[FX, 0, CX + 1], [0, FY, CY + 1], [0, 0, 1]])
    return {
        "RadialDistortion": np.array([[K1, K2, K3]]),
        "TangentialDistortion": np.array([[P1, P2]]),
        "ImageSize": np.array([[480.0, 640.0]]),
        "WorldUnits": "mm",
        **({"K": matrix} if with_k else {"IntrinsicMatrix": matrix.T}),
    }


def matlab(content: dict[str, Any]) -> Callable[[Path], None]:
    """Return a function that writes a file of version 5."""

    def write(path: Path) -> None:
        from scipy.io import savemat

        savemat(path, content)

    return write


def matlab_73(content: dict[str, Any], *, is_object: bool = False) -> Callable[[Path], None]:
    """Return a function that writes a file of version 7.3, in which arrays are transposed."""

    def write(path: Path) -> None:
        import h5py

        with h5py.File(path, "w", userblock_size=512) as file:
            if is_object:
                file.create_dataset("cameraParams", data=np.zeros((1, 6), dtype=np.uint32))
                file["cameraParams"].attrs["MATLAB_object_decode"] = np.int32(3)
                return
            group = file.create_group("cameraParams")
            for key, value in content.items():
                text = isinstance(value, str)
                group.create_dataset(
                    key, data=np.array([list(map(ord, value))], dtype=np.uint16).T if text else value.T
                )
        with path.open("r+b") as raw:
            raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")

    return write


STEREO = {
    "CameraParameters1": matlab_struct(),
    "CameraParameters2": matlab_struct(with_k=True),
    "RotationOfCamera2": R.T,
    "TranslationOfCamera2": np.array([SHIFT]),
}

BOUGUET = {
    "fc": np.array([[FX], [FY]]),
    "cc": np.array([[CX], [CY]]),
    "kc": np.array([[K1], [K2], [P1], [P2], [K3]]),
    "alpha_c": 0.0,
    "nx": 640,
    "ny": 480,
}

FILES = [
    CameraFile(
        "Bouguet's toolbox",
        "Calib_Results.mat",
        matlab(BOUGUET),
        truth(k3=K3),
        "px, first pixel centre (0, 0); k1 k2 p1 p2 k3",
        "fedic",
    ),
    CameraFile("MATLAB toStruct, version 5", "a.mat", matlab(matlab_struct()), truth(k3=K3), _MATLAB, "fedic"),
    CameraFile(
        "MATLAB toStruct with K", "a.mat", matlab({"s": matlab_struct(with_k=True)}), truth(k3=K3), _MATLAB, "fedic"
    ),
    CameraFile("MATLAB toStruct, version 7.3", "a.mat", matlab_73(matlab_struct()), truth(k3=K3), _MATLAB, "h5py"),
    CameraFile("MATLAB stereo", "a.mat", matlab(STEREO), truth(second=True, k3=K3), "X_1 = R' X_0 + T", "fedic", 1),
    CameraFile(
        "MATLAB object", "a.mat", matlab_73({}, is_object=True), "An object of MATLAB cannot be read", "", "h5py"
    ),
]
