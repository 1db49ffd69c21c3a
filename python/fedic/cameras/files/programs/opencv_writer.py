"""Writing of cameras in the files of OpenCV's ``FileStorage``."""

from pathlib import Path

from fedic._core import Pinhole
from fedic.cameras.files.matrices import matrices_of_camera
from fedic.io.atomic import atomic_path

__all__ = ["write_opencv"]


def write_opencv(camera: object, path: Path) -> None:
    """Write a camera in the format of OpenCV's sample programs, with its pose as ``rvec`` and ``tvec``."""
    import cv2

    matrix, distortion, rotation, translation = matrices_of_camera(path, camera)
    size = camera.image_size if isinstance(camera, Pinhole) else None
    with atomic_path(path) as temporary:
        storage = cv2.FileStorage(str(temporary), cv2.FILE_STORAGE_WRITE)
        if not storage.isOpened():
            raise FileNotFoundError(temporary)
        if size is not None:
            storage.write("image_width", size[0])
            storage.write("image_height", size[1])
        storage.write("camera_matrix", matrix)
        storage.write("distortion_coefficients", distortion)
        storage.write("rvec", cv2.Rodrigues(rotation)[0])
        storage.write("tvec", translation.reshape(3, 1))
        storage.release()
