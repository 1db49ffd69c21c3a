"""Names of lens models in files of other programs."""

import re
from pathlib import Path

from fedic.errors import CameraError

__all__ = ["check_lens_model", "check_projection"]

_BROWN = (
    "plumb_bob", "radtan", "radial-tangential", "brown", "brown-conrady", "opencv", "opencv5", "standard", "polynomial",
    "rational_polynomial", "none", "no_distortion",
)  # fmt: skip
"""Models whose coefficients are k1 k2 p1 p2 k3 of Brown's, or that have none; k4 to k6 of the rational are checked."""
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
    if _plain(name) not in {"", *map(_plain, _BROWN)}:
        raise CameraError(
            f"{path}: {key}: the lens model {name!r} is not supported; those that are Brown's: {', '.join(_BROWN)}. "
            "Calibrate as a pinhole camera with radial and tangential coefficients."
        )


def check_projection(path: Path, key: str, name: str) -> None:
    """Check that a projection, in any spelling, is that of a pinhole; parameters and errors as `check_lens_model`."""
    if _plain(name) not in {"", *_PINHOLE}:
        raise CameraError(
            f"{path}: {key}: the projection {name!r} is not supported, only that of a pinhole; calibrate as a pinhole "
            "camera. (If it is the name of the camera, leave the line out.)"
        )


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())
