"""Names of lens models, the interface of a lens that can be fitted, and the Brown-Conrady model."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fedic._core import BrownDistortion, Distortion, Pinhole
from fedic._internal.types import Floats
from fedic.errors import OptionError

__all__ = ["BROWN", "RADIAL", "SPLINES", "BrownLens", "Lens", "parse_lens"]

_COEFFICIENTS = {"k1": 0, "k2": 1, "d1": 2, "d2": 3, "k3": 4, "p1": 8, "p2": 10}
"""Index of each coefficient among OpenCV's twelve: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4."""

_ORDER = ("k1", "k2", "k3", "d1", "d2", "p1", "p2")

SPLINES = ("spline", "inverse-spline")
"""Names of the non-parametric models, see `fedic.calibration.lenses.SplineLens`."""

_WORDS = {
    "none": (),
    "radial1": ("k1",),
    "radial2": ("k1", "k2"),
    "radial3": ("k1", "k2", "k3"),
    "decentering": ("d1", "d2"),
    "prism": ("p1", "p2"),
    "brown": ("k1", "k2", "k3", "d1", "d2"),
}


class Lens(Protocol):
    """A camera model without its pose, to be fitted.

    Its unknowns begin with fx, fy, cx and cy.
    """

    @property
    def name(self) -> str:
        """Name, such as ``"radial1+prism"``."""

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the first unknowns; the others have none."""

    @property
    def size(self) -> int:
        """Number of unknowns."""

    @property
    def tolerance(self) -> float:
        """Length of a correction at the minimum, in standard deviations of a residual."""

    @property
    def first_damping(self) -> float:
        """Damping of the first step: small where the start is near."""

    @property
    def penalty(self) -> Floats | None:
        """Matrix (size, size) of a quadratic form of the unknowns that is added to the cost, or None."""

    def linearised(self, values: Floats, positions: Floats) -> tuple[Floats, Floats, Floats]:
        """Project points of the camera frame.

        Parameters
        ----------
        values : ndarray, shape (size,)
            Values of the unknowns.
        positions : ndarray, shape (n, 3)
            Points in the camera frame.

        Returns
        -------
        pixels : ndarray, shape (n, 2)
        by_values : ndarray, shape (n, 2, size)
        by_positions : ndarray, shape (n, 2, 3)
        """

    def distortion(self, values: Floats) -> Distortion | None:
        """Return the distortion for given values of the unknowns, in the form in which it is fitted."""

    def camera(self, values: Floats, rotation: Floats, translation: Floats) -> Pinhole:
        """Return the camera for given values of the unknowns and a pose: rotation (3, 3) and translation (3,)."""


@dataclass(frozen=True)
class BrownLens:
    """A camera with a `fedic.BrownDistortion` of which some coefficients are free and the others zero.

    Attributes
    ----------
    name : str
        Name, such as ``"radial1+prism"``.
    coefficients : tuple of str
        Free coefficients among ``k1 k2 k3 d1 d2 p1 p2``, in this order.
    """

    name: str
    coefficients: tuple[str, ...]

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of all the unknowns."""
        return ("fx", "fy", "cx", "cy", *self.coefficients)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.parameters)

    @property
    def tolerance(self) -> float:
        """See `Lens.tolerance`."""
        return 1e-5

    @property
    def first_damping(self) -> float:
        """See `Lens.first_damping`."""
        return 1e-3

    @property
    def penalty(self) -> None:
        """None: the coefficients are free."""
        return

    def linearised(self, values: Floats, positions: Floats) -> tuple[Floats, Floats, Floats]:
        """Project points of the camera frame, see `Lens.linearised`."""
        import cv2

        projected = cv2.projectPoints(positions, np.zeros(3), np.zeros(3), *self._matrices(values))
        pixels, slopes = (np.asarray(part, dtype=np.float64) for part in projected)
        slopes = slopes.reshape(len(positions), 2, -1)
        chosen = [6, 7, 8, 9, *(10 + _COEFFICIENTS[name] for name in self.coefficients)]
        return pixels.reshape(-1, 2), slopes[:, :, chosen], slopes[:, :, 3:6]

    def distortion(self, values: Floats) -> Distortion | None:
        """Return the distortion for given values of the unknowns; None if no coefficient is free."""
        if not self.coefficients:
            return None
        by_name = dict(zip(self.coefficients, (float(value) for value in values[4:]), strict=True))
        k1, k2, k3, d1, d2, p1, p2 = (by_name.get(name, 0.0) for name in _ORDER)
        return BrownDistortion((k1, k2, k3), (d1, d2), (p1, p2))

    def camera(self, values: Floats, rotation: Floats, translation: Floats) -> Pinhole:
        """Return the camera for given values of the unknowns and a pose."""
        fx, fy, cx, cy = (float(value) for value in values[:4])
        tx, ty, tz = (float(value) for value in translation)
        lens = self.distortion(values)
        return Pinhole((fx, fy), (cx, cy), rotation=rotation, translation=(tx, ty, tz), distortion=lens)

    def _matrices(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the camera matrix and the twelve distortion coefficients of OpenCV."""
        fx, fy, cx, cy = values[:4]
        distortion = np.zeros(12)
        distortion[[_COEFFICIENTS[name] for name in self.coefficients]] = values[4:]
        return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]), distortion


BROWN, RADIAL = (BrownLens(word, _WORDS[word]) for word in ("brown", "radial1"))
"""Models with five coefficients and with one."""


def parse_lens(distortion: str | Sequence[str]) -> BrownLens | str:
    """Parse the name of a lens model.

    Parameters
    ----------
    distortion : str or sequence of str
        ``"spline"`` or ``"inverse-spline"``; or any of ``"none"``, ``"radial1"`` (k1), ``"radial2"`` (k1, k2),
        ``"radial3"`` (k1 to k3), ``"decentering"``, ``"prism"`` and ``"brown"`` (radial3 and decentering), joined by
        ``+`` or in a sequence.

    Returns
    -------
    BrownLens or str
        The model, or the name of a non-parametric one.

    Raises
    ------
    OptionError
        If a name is unknown, or a spline is combined with another model.
    """
    words = distortion.split("+") if isinstance(distortion, str) else list(distortion)
    words = [re.sub(r"\s", "", word) for word in words]
    unknown = [word for word in words if word not in (*_WORDS, *SPLINES)]
    if unknown or not words:
        given = unknown[0] if unknown else ""
        known = ", ".join((*_WORDS, *SPLINES))
        raise OptionError(
            f"distortion: {given!r} is unknown; give one of {known}, or several without splines joined by '+'.",
            "distortion",
        )
    if len(words) > 1 and any(word in SPLINES for word in words):
        raise OptionError(
            f"distortion: {'+'.join(words)!r}: a spline has any shape; leave out the other models.", "distortion"
        )
    if words[0] in SPLINES:
        return words[0]
    free = {name for word in words for name in _WORDS[word]}
    return BrownLens("+".join(words), tuple(name for name in _ORDER if name in free))
