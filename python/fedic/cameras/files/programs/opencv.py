"""Cameras under the names that OpenCV's programs use, in YAML, XML or arrays."""

from collections.abc import Sequence
from pathlib import Path

from fedic.cameras.files.file_camera import FileCamera
from fedic.cameras.files.lens_models import check_lens_model, check_no_other_lens, check_projection, plain_name
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
        "dist_coefs", "distortion_coeffs", "distortion_coefficient", "dist", "kc", "D",
    ),
    "rotation": ("rvec", "rotation_vector", "rotation_matrix", "rotation", "R"),
    "translation": ("tvec", "translation_vector", "translation", "T", "t"),
}  # fmt: skip
"""Keys under which other programs store each matrix; of longer ones, case and separators do not count."""
_SHORT = 2
"""Length of names whose case counts: K1 is a matrix, k1 a coefficient."""

_SINGLE_LETTERS = {"matrix": ("M", "K"), "distortion": ("D",)}
"""Names of two cameras that have a number or letter added."""
_SIDES = (("0", "1"), ("1", "2"), ("L", "R"), ("l", "r"), ("left", "right"))
"""What is added to the names of two cameras, before or after."""
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
    if "distortion" not in found:
        rest = {key: value for key, value in tree.items() if key not in keys.values()}
        check_no_other_lens(path, rest, KEYS["distortion"][0])
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
    single = {what: _key_among(names, keys) for what, keys in KEYS.items()}
    if single["matrix"]:
        if number != 0:
            raise CameraError(f"{path}: there is no camera {number}; the file holds one, number 0.")
        return {what: key for what, key in single.items() if key}
    for sides in _SIDES:
        # Numbers that begin at 0 are told by the 0: K1 is the second camera beside K0, and the first beside K2.
        told_by = sides[:1] if sides[0] == "0" else sides
        if any(_key_among(names, _forms("matrix", side)) for side in told_by) and 0 <= number < len(sides):
            paired = {what: _key_among(names, _forms(what, sides[number])) for what in _SINGLE_LETTERS}
            if paired["matrix"]:
                pose = {what: single[what] for what in ("rotation", "translation")} if number else {}
                return {what: key for what, key in {**paired, **pose}.items() if key}
    which = f" of camera {number}" if number else ""
    raise CameraError(
        f"{path}: there is no camera matrix{which}; name it camera_matrix, or K1 and K2 if there are two "
        f"(docs/cameras.md has other names); the file holds {', '.join(names[:20]) or 'nothing'}."
    )


def _forms(what: str, side: str) -> list[str]:
    bases = (*_SINGLE_LETTERS[what], *KEYS[what])
    return [form for base in bases for form in (f"{base}{side}", f"{base}_{side}", f"{side}_{base}")]


def _key_among(names: list[str], forms: Sequence[str]) -> str:
    """Return the first of some names that a file has, or else one that differs in case and separators only."""
    plain = {plain_name(form) for form in forms}
    return next((form for form in forms if form in names), "") or next(
        (name for name in names if len(name) > _SHORT and plain_name(name) in plain), ""
    )
