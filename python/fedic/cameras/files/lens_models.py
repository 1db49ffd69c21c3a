"""Names of lens models in files of other programs."""

import re
from pathlib import Path

from fedic.cameras.files.syntax.tree import Tree, numbers
from fedic.errors import CameraError

__all__ = ["check_lens_model", "check_no_other_lens", "check_projection", "plain_name"]

_BROWN = (
    "plumb_bob", "radtan", "radial-tangential", "brown", "brown-conrady", "opencv", "opencv5", "standard", "polynomial",
    "rational_polynomial", "none", "no_distortion",
)  # fmt: skip
"""Models whose coefficients are k1 k2 p1 p2 k3 of Brown's, or that have none; k4 to k6 of the rational are checked."""
_COEFFICIENTS = re.compile(r"dist|coef|lens|kc|^d.?$", re.IGNORECASE)
_ONE_COEFFICIENT = re.compile(r"([kp]|kappa)[_ ]?[1-6]", re.IGNORECASE)
_PINHOLE = ("pinhole", "perspective", "frame", "planar")


def check_lens_model(path: Path, key: str, name: str) -> None:
    """Check that a lens model, in any spelling, is Brown's.

    Parameters
    ----------
    path : Path
        The file, for messages.
    key : str
        Key that holds the name.
    name : str
        Name of the model; empty if it is not given.

    Raises
    ------
    CameraError
        If the model is another one.
    """
    if plain_name(name) not in {"", *map(plain_name, _BROWN)}:
        raise CameraError(
            f"{path}: {key}: the lens model {name!r} is not supported; those that are Brown's: {', '.join(_BROWN)}. "
            "Calibrate as a pinhole camera with radial and tangential coefficients."
        )


def check_projection(path: Path, key: str, name: str) -> None:
    """Check that a projection, in any spelling, is that of a pinhole; parameters and errors as `check_lens_model`."""
    if plain_name(name) not in {"", *_PINHOLE}:
        raise CameraError(
            f"{path}: {key}: the projection {name!r} is not supported, only that of a pinhole; calibrate as a pinhole "
            "camera. (If it is the name of the camera, leave the line out.)"
        )


def check_no_other_lens(path: Path, tree: dict[str, Tree], name: str) -> None:
    """Check that a file without coefficients of a lens has none under a name that is not known.

    Parameters
    ----------
    path : Path
        The file, for messages.
    tree : dict of str to Tree
        Entries of the file that are not used.
    name : str
        The name that the coefficients should have.

    Raises
    ------
    CameraError
        If one is named as coefficients of a lens are, and has numbers other than zero.
    """
    for key, value in tree.items():
        of_one = _ONE_COEFFICIENT.fullmatch(key) is not None
        if not of_one and (_COEFFICIENTS.search(key) is None or "distance" in key.lower()):
            continue
        try:
            found = numbers(path, key, value)
        except CameraError:
            continue
        if found.any() and (found.size == 1 if of_one else found.size > 1):
            raise CameraError(
                f"{path}: {key} looks like coefficients of the lens, under a name that is not known: name them "
                f"{name}, in the order k1 k2 p1 p2 k3, or remove them if they are something else."
            )


def plain_name(name: str) -> str:
    """Return a name in small letters, without separators."""
    return re.sub(r"[^a-z0-9]", "", name.lower())
