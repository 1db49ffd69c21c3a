"""The words that name a lens model, and the parameters each leaves free."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fedic._core import BrownDistortion, Pinhole
from fedic._types import Floats
from fedic.errors import CameraError

__all__ = ["COEFFICIENTS", "Lens", "parse_lens", "pinhole"]

COEFFICIENTS = {"k1": 0, "k2": 1, "d1": 2, "d2": 3, "k3": 4, "p1": 8, "p2": 10}
"""The place of each coefficient among OpenCV's twelve: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4."""

_WORDS = {
    "none": (),
    "radial1": ("k1",),
    "radial2": ("k1", "k2"),
    "radial3": ("k1", "k2", "k3"),
    "decentering": ("d1", "d2"),
    "prism": ("p1", "p2"),
    "brown": ("k1", "k2", "k3", "d1", "d2"),
}


@dataclass(frozen=True)
class Lens:
    """A lens model: which coefficients of `fedic.BrownDistortion` are free, the others being zero.

    Attributes
    ----------
    name : str
        Its words, joined by ``+``.
    coefficients : tuple of str
        Of ``k1 k2 k3 d1 d2 p1 p2``, in this order.
    """

    name: str
    coefficients: tuple[str, ...]

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of all the free intrinsic parameters."""
        return ("fx", "fy", "cx", "cy", *self.coefficients)

    def split(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the camera matrix and the twelve distortion coefficients of OpenCV for values of `parameters`."""
        fx, fy, cx, cy = values[:4]
        distortion = np.zeros(12)
        distortion[[COEFFICIENTS[name] for name in self.coefficients]] = values[4:]
        return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]), distortion


def parse_lens(distortion: str | Sequence[str]) -> Lens:
    """Read the name of a lens model.

    Parameters
    ----------
    distortion : str or sequence of str
        Any of ``"none"``, ``"radial1"`` (k1), ``"radial2"`` (k1, k2), ``"radial3"`` (k1 to k3), ``"decentering"``,
        ``"prism"`` and ``"brown"`` (radial3 and decentering), joined by ``+`` or in a sequence.

    Returns
    -------
    Lens
        The model.

    Raises
    ------
    CameraError
        If a word is unknown.
    """
    words = distortion.split("+") if isinstance(distortion, str) else list(distortion)
    words = [re.sub(r"\s", "", word) for word in words]
    unknown = [word for word in words if word not in _WORDS]
    if unknown or not words:
        given = unknown[0] if unknown else ""
        raise CameraError(f"distortion: {given!r} is unknown; give {', '.join(_WORDS)}, or several joined by '+'.")
    free = {name for word in words for name in _WORDS[word]}
    order = ("k1", "k2", "k3", "d1", "d2", "p1", "p2")
    return Lens("+".join(words), tuple(name for name in order if name in free))


def pinhole(lens: Lens, values: Floats, rotation: Floats, translation: Floats) -> Pinhole:
    """Make the camera of some values of the parameters.

    Parameters
    ----------
    lens : Lens
        The model.
    values : ndarray, shape (p,)
        Of `Lens.parameters`.
    rotation : ndarray, shape (3, 3)
        From the world to the camera.
    translation : ndarray, shape (3,)
        In the world's unit.

    Returns
    -------
    Pinhole
        The camera.
    """
    by_name = dict(zip(lens.parameters, (float(value) for value in values), strict=True))
    k1, k2, k3, d1, d2, p1, p2 = (by_name.get(name, 0.0) for name in ("k1", "k2", "k3", "d1", "d2", "p1", "p2"))
    tx, ty, tz = (float(value) for value in translation)
    return Pinhole(
        (by_name["fx"], by_name["fy"]),
        (by_name["cx"], by_name["cy"]),
        rotation=rotation,
        translation=(tx, ty, tz),
        distortion=BrownDistortion((k1, k2, k3), (d1, d2), (p1, p2)) if lens.coefficients else None,
    )
