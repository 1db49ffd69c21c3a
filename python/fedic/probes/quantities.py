"""Fields that tables hold: their values, and their derivatives for the propagation of the noise."""

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from fedic._internal.types import Floats
from fedic.errors import OptionError

__all__ = ["QUANTITIES", "Quantity", "checked_fields"]

Rule: TypeAlias = Callable[[Floats, Floats], tuple[float, Floats]]
"""Value and derivative of a field from the means it follows from, and the line of an extensometer."""


class Quantity(NamedTuple):
    """A field of tables.

    Attributes
    ----------
    source : {"displacement", "pixels", "strain", "ends", "quality"}
        Means that it follows from: ``(x, y)``; ``(u, v)``; ``(exx, eyy, exy)``; the displacement of both points of an
        extensometer, ``(xa, ya, xb, yb)``; or the quality of the cells, which has no standard deviation.
    rule : callable
        Its value and derivative with respect to these means.
    """

    source: str
    rule: Rule


def checked_fields(fields: str | Sequence[str]) -> list[str]:
    """Check the names of fields.

    Parameters
    ----------
    fields : str or sequence of str
        The names.

    Returns
    -------
    list of str
        The names in order, each once.

    Raises
    ------
    OptionError
        If there is none, or one is unknown.
    """
    names = [fields] if isinstance(fields, str) else list(fields)
    for name in names:
        if name not in QUANTITIES:
            raise OptionError(f"fields has {name!r}; choose from {', '.join(QUANTITIES)}.", "fields")
    if not names:
        raise OptionError(f"fields is empty; choose from {', '.join(QUANTITIES)}.", "fields")
    return list(dict.fromkeys(names))


def _component(index: int) -> Rule:
    def rule(means: Floats, line: Floats) -> tuple[float, Floats]:
        return float(means[index]), np.eye(len(means))[index]

    return rule


def _magnitude(means: Floats, line: Floats) -> tuple[float, Floats]:
    length = np.hypot(*means)
    return float(length), means / length


def _principal(sign: float) -> Rule:
    def rule(means: Floats, line: Floats) -> tuple[float, Floats]:
        exx, eyy, exy = means
        half = 0.5 * (exx - eyy)
        radius = np.hypot(half, exy)
        turned = np.array([0.5 * half, -0.5 * half, exy]) / radius
        return float(0.5 * (exx + eyy) + sign * radius), np.array([0.5, 0.5, 0.0]) + sign * turned

    return rule


def _von_mises(means: Floats, line: Floats) -> tuple[float, Floats]:
    exx, eyy, exy = means
    root = np.sqrt(exx**2 + exx * eyy + eyy**2 + exy**2)
    factor = 2.0 / np.sqrt(3.0)
    return float(factor * root), factor * np.array([exx + 0.5 * eyy, eyy + 0.5 * exx, exy]) / root


def _elongation(means: Floats, line: Floats) -> tuple[float, Floats]:
    moved = line + means[2:] - means[:2]
    length, before = np.hypot(*moved), np.hypot(*line)
    return float(length - before), np.array([*-moved, *moved]) / length


def _engineering_strain(means: Floats, line: Floats) -> tuple[float, Floats]:
    elongation, slope = _elongation(means, line)
    before = np.hypot(*line)
    return float(elongation / before), slope / before


def _rotation(means: Floats, line: Floats) -> tuple[float, Floats]:
    moved = line + means[2:] - means[:2]
    angle = np.arctan2(line[0] * moved[1] - line[1] * moved[0], line @ moved)
    across = np.array([-moved[1], moved[0]]) / (moved @ moved)
    return float(angle), np.array([*-across, *across])


QUANTITIES = {
    "x": Quantity("displacement", _component(0)),
    "y": Quantity("displacement", _component(1)),
    "magnitude": Quantity("displacement", _magnitude),
    "u": Quantity("pixels", _component(0)),
    "v": Quantity("pixels", _component(1)),
    "exx": Quantity("strain", _component(0)),
    "eyy": Quantity("strain", _component(1)),
    "exy": Quantity("strain", _component(2)),
    "e1": Quantity("strain", _principal(1.0)),
    "e2": Quantity("strain", _principal(-1.0)),
    "von_mises": Quantity("strain", _von_mises),
    "strain": Quantity("ends", _engineering_strain),
    "elongation": Quantity("ends", _elongation),
    "rotation": Quantity("ends", _rotation),
    "residual": Quantity("quality", _component(0)),
    "correlation": Quantity("quality", _component(1)),
    "measured_share": Quantity("quality", _component(2)),
}
"""The fields by name."""
