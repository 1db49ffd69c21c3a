"""Names of lens models, the interface of a lens that can be fitted, and the models of a few coefficients."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fedic._core import LENSES, Distortion, Pinhole
from fedic._internal.types import Floats
from fedic.errors import CameraError, OptionError

__all__ = ["BROWN", "POSE", "RADIAL", "SPLINES", "CoefficientLens", "Lens", "parse_lens"]

POSE = ("rx", "ry", "rz", "tx", "ty", "tz")
"""Parameters of the pose of a `fedic.Pinhole`."""

SPLINES = tuple(name for name, model in LENSES.items() if not model.parameters)
"""Names of the non-parametric models, see `fedic.calibration.lenses.SplineLens`."""

_BROWN_WORDS = {
    "radial1": ("k1",),
    "radial2": ("k1", "k2"),
    "radial3": ("k1", "k2", "k3"),
    "decentering": ("d1", "d2"),
    "prism": ("p1", "p2"),
    "brown": ("k1", "k2", "k3", "d1", "d2"),
}
"""Parts of Brown's model and their coefficients."""

_WORDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "none": ("brown", ()),
    **{word: ("brown", coefficients) for word, coefficients in _BROWN_WORDS.items()},
    **{name: (name, model.parameters) for name, model in LENSES.items() if model.parameters and name != "brown"},
}
"""Lens model and free coefficients of each name; the name of any other model frees all its coefficients."""


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

    def linearised(
        self, values: Floats, rotation: Floats, translation: Floats, points: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Project points, with derivatives; NaN if the values are not those of a camera.

        Parameters
        ----------
        values : ndarray, shape (size,)
            Values of the unknowns.
        rotation, translation : ndarray, shapes (3, 3) and (3,)
            Pose of the camera.
        points : ndarray, shape (n, 3)
            World points.

        Returns
        -------
        pixels : ndarray, shape (n, 2)
            Image points.
        by_values : ndarray, shape (n, 2, size)
            Derivatives with respect to the unknowns.
        by_pose : ndarray, shape (n, 2, 6)
            Derivatives with respect to the pose, see `fedic.Pinhole.perturbed`.
        """

    def distortion(self, values: Floats) -> Distortion | None:
        """Return the distortion for given values of the unknowns, in the form in which it is fitted."""

    def camera(self, values: Floats, rotation: Floats, translation: Floats) -> Pinhole:
        """Return the camera for given values of the unknowns and a pose: rotation (3, 3) and translation (3,)."""


@dataclass(frozen=True)
class CoefficientLens:
    """A camera with a lens of a few coefficients, of which some are free and the others zero.

    Attributes
    ----------
    name : str
        Name, such as ``"radial1+prism"``.
    model : str
        Name of the lens model in `fedic._core.LENSES`.
    coefficients : tuple of str
        Free coefficients, in the order of the model.
    """

    name: str
    model: str
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

    def linearised(
        self, values: Floats, rotation: Floats, translation: Floats, points: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Project points, with derivatives, see `Lens.linearised`."""
        try:
            camera = self.camera(values, rotation, translation)
        except CameraError:
            count = len(points)
            return tuple(np.full((count, 2, *rest), np.nan) for rest in ((), (self.size,), (6,)))  # type: ignore[return-value]
        jacobian = camera.parameter_jacobian(points, (*self.parameters, *POSE))
        return camera.project(points), jacobian[:, :, :-6], jacobian[:, :, -6:]

    def distortion(self, values: Floats) -> Distortion | None:
        """Return the distortion for given values of the unknowns; None if no coefficient is free."""
        if not self.coefficients:
            return None
        by_name = dict(zip(self.coefficients, (float(value) for value in values[4:]), strict=True))
        model = LENSES[self.model]
        groups = {group: tuple(by_name.get(name, 0.0) for name in names) for group, names in model.groups.items()}
        return model.lens(**groups)

    def camera(self, values: Floats, rotation: Floats, translation: Floats) -> Pinhole:
        """Return the camera for given values of the unknowns and a pose."""
        fx, fy, cx, cy = (float(value) for value in values[:4])
        tx, ty, tz = (float(value) for value in translation)
        lens = self.distortion(values)
        return Pinhole((fx, fy), (cx, cy), rotation=rotation, translation=(tx, ty, tz), distortion=lens)


BROWN, RADIAL = (CoefficientLens(word, *_WORDS[word]) for word in ("brown", "radial1"))
"""Models with five coefficients and with one."""


def parse_lens(distortion: str | Sequence[str]) -> CoefficientLens | str:
    """Parse the name of a lens model.

    Parameters
    ----------
    distortion : str or sequence of str
        ``"spline"`` or ``"inverse-spline"``; or any of ``"none"``, ``"radial1"`` (k1), ``"radial2"`` (k1, k2),
        ``"radial3"`` (k1 to k3), ``"decentering"``, ``"prism"`` and ``"brown"`` (radial3 and decentering), joined by
        ``+`` or in a sequence; or the name of another model of `fedic._core.LENSES`, with all its coefficients.

    Returns
    -------
    CoefficientLens or str
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
    models = {_WORDS[word][0] for word in words if word != "none"} or {"brown"}
    if len(models) > 1:
        raise OptionError(
            f"distortion: {'+'.join(words)!r} combines the models {' and '.join(sorted(models))}; give one of them.",
            "distortion",
        )
    (model,) = models
    free = {name for word in words for name in _WORDS[word][1]}
    return CoefficientLens("+".join(words), model, tuple(name for name in LENSES[model].parameters if name in free))
