"""Cameras under the names that OpenCV's programs use, in YAML, XML or arrays."""

from pathlib import Path

from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.lens_models import check_lens_model, check_projection
from fedic.cameras.files.matrices import camera_from_matrices
from fedic.cameras.files.syntax.tree import Tree, numbers, text_of
from fedic.errors import CameraError

__all__ = ["opencv_camera", "size_of_image"]

KEYS = {
    "matrix": (
        "camera_matrix", "cameraMatrix", "Camera_Matrix", "CameraMatrix", "intrinsic_matrix", "intrinsics", "mtx", "K",
    ),
    "distortion": (
        "distortion_coefficients", "Distortion_Coefficients", "distortion", "dist_coeffs", "dist_coeff", "distCoeffs",
        "dist_coefs", "dist", "D",
    ),
    "rotation": ("rvec", "rotation_vector", "rotation_matrix", "rotation", "R"),
    "translation": ("tvec", "translation_vector", "translation", "T", "t"),
}  # fmt: skip
"""Keys under which other programs store each matrix."""

_PAIRS = {
    "matrix": ("M{}", "K{}", "cameraMatrix{}", "camera_matrix_{}", "mtx{}"),
    "distortion": ("D{}", "distCoeffs{}", "dist_coeffs_{}", "dist{}"),
}
_LENS_MODELS = ("distortion_model", "distortionModel", "distortion_type", "lens_model", "distortion_name")
_PROJECTIONS = ("camera_model", "cameraModel", "model_type", "projection_model")
_SIZES = (
    ("image_width", "image_height"),
    ("image_Width", "image_Height"),
    ("imageWidth", "imageHeight"),
    ("ImageWidth", "ImageHeight"),
    ("width", "height"),
)
_SIZE_PAIRS = ("image_size", "imageSize", "image_Size", "img_size", "resolution")


def opencv_camera(path: Path, tree: dict[str, Tree], number: int) -> FileCamera:
    """Return a camera whose matrices have the names of OpenCV's programs.

    Parameters
    ----------
    path : Path
        The file, for messages.
    tree : dict of str to Tree
        Content of the file.
    number : int
        Index of the camera, 0 or 1.

    Returns
    -------
    FileCamera
        The camera.

    Raises
    ------
    CameraError
        If there is no such camera, its lens is not supported, or a matrix is malformed.
    """
    _check_models(path, tree)
    keys = _keys_of(path, list(tree), number)
    found = {what: (key, tree[key]) for what, key in keys.items()}
    second = number > 0
    missing = [what for what in ("rotation", "translation") if what not in found] if second else []
    if missing:
        found = {what: entry for what, entry in found.items() if what in ("matrix", "distortion")}
    camera = camera_from_matrices(
        path,
        found["matrix"],
        found.get("distortion"),
        found.get("rotation"),
        found.get("translation"),
        size_of_image(path, tree),
    )
    sentence = (
        f"the {' and the '.join(missing)} of camera {number} relative to the first (R, T) are missing: a second camera "
        "without them would be where the first is. OpenCV's stereo programs write them into another file, "
        "extrinsics.yml: copy them from there."
    )
    return FileCamera(camera, sentence if missing else "")


def size_of_image(path: Path, tree: dict[str, Tree]) -> tuple[int, int] | None:
    """Return width and height of the image if the file has them."""
    pair = next((names for names in _SIZES if all(name in tree for name in names)), None)
    single = next((name for name in _SIZE_PAIRS if name in tree), None)
    if pair is not None:
        key, values = " and ".join(pair), [numbers(path, name, tree[name], 1)[0] for name in pair]
    elif single is not None:
        key, values = single, list(numbers(path, single, tree[single], 2))
    else:
        return None
    width, height = (int(value) if value == int(value) else -1 for value in values)
    if not (0 <= width < 2**31 and 0 <= height < 2**31):
        raise CameraError(f"{path}: {key}: an image of {values[0]:g} x {values[1]:g} px does not exist.")
    return (width, height) if width and height else None


def _check_models(path: Path, tree: dict[str, Tree]) -> None:
    """Check what the file says of the lens."""
    for key, value in tree.items():
        if key in _LENS_MODELS:
            check_lens_model(path, key, text_of(value))
        elif key in _PROJECTIONS:
            check_projection(path, key, text_of(value))
        elif "fisheye" in key.lower() and text_of(value).lower() not in ("", "0", "0.0", "0.", "false", "none"):
            raise CameraError(
                f"{path}: {key} = {text_of(value)}: a fisheye lens is not supported; calibrate as a pinhole."
            )


def _keys_of(path: Path, names: list[str], number: int) -> dict[str, str]:
    """Return the key of each matrix in a file: ``matrix`` and, if present, ``distortion``, ``rotation`` and so on."""
    single = {what: next((key for key in keys if key in names), "") for what, keys in KEYS.items()}
    forms = {what: [key.format(number + 1) for key in keys] for what, keys in _PAIRS.items()}
    paired = {what: next((key for key in keys if key in names), "") for what, keys in forms.items()}
    if single["matrix"]:
        if number != 0:
            raise CameraError(f"{path}: there is no camera {number}; the file holds one, number 0.")
        return {what: key for what, key in single.items() if key}
    if not paired["matrix"]:
        expected = ", ".join([*KEYS["matrix"], *forms["matrix"]])
        raise CameraError(
            f"{path}: there is no camera matrix {f'of camera {number} ' if number else ''}under any of the keys "
            f"{expected}; the file holds {', '.join(names[:20]) or 'nothing'}."
        )
    pose = {what: single[what] for what in ("rotation", "translation")} if number else {}
    return {what: key for what, key in {**paired, **pose}.items() if key}
