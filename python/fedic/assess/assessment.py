"""Deviations of a measurement on static and rigidly moved specimens, and the verdict on them."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fedic._internal.types import Floats
from fedic.assess.statistics import Deviations, PixelSize

__all__ = ["LIMITS", "Assessment", "Check", "Reading"]

LIMITS = {
    "zd": "zero displacement deviation ZD",
    "zs": "zero strain deviation ZS",
    "d": "largest displacement deviation D",
    "rotation": "largest deviation of the rotation (degrees)",
}
"""Names of the limits, and what each is of."""


@dataclass(frozen=True)
class Reading:
    """What one image of a pose reads.

    Attributes
    ----------
    pose : str
        Name of the pose.
    displacement : ndarray, shape (2,)
        Mean displacement of the squares, in the mesh's unit.
    rotation : float
        Rotation in degrees.
    deviation : ndarray, shape (2,)
        ``|measured - set|`` along x and y; NaN if no displacement was set.
    rotation_deviation : float
        ``|measured - set|`` in degrees; NaN if no rotation was set.
    squares : int
        Number of squares measured.
    """

    pose: str
    displacement: Floats
    rotation: float
    deviation: Floats
    rotation_deviation: float
    squares: int


@dataclass(frozen=True)
class Check:
    """A value against its limit.

    Attributes
    ----------
    name : str
        A key of `LIMITS`.
    value, limit : float
        The value, and the largest that is allowed.
    """

    name: str
    value: float
    limit: float

    @property
    def holds(self) -> bool:
        """Whether the value is known and does not exceed the limit."""
        return self.value <= self.limit


@dataclass(frozen=True, eq=False)
class Assessment:
    """Deviations of a measurement, after EN 4861 and VDI/VDE 2626 Part 1; no claim of conformity with either.

    Attributes
    ----------
    square : float
        Side of the squares, in the mesh's unit.
    zero_displacement : ndarray, shape (3,)
        ZD: root mean square of the displacement of the squares without the rigid motion of each image; and of its
        components along x and y.
    zero_strain : ndarray, shape (4,)
        ZS: root mean square of ``exx, eyy, exy`` of the squares; and of each.
    readings : list of Reading
        One for each image.
    along : tuple of Deviations
        Deviations of the displacement along x and y.
    rotation : Deviations
        Deviations of the rotation, in degrees.
    pixel : PixelSize
        Size of a pixel on the specimen, from the set displacements that are not zero.
    checks : list of Check
        The values that have a limit.
    num_poses : int
        Number of poses.
    not_measured : int
        Nodes that were not measured, over all images; they are left out.
    squares_left_out : int
        Squares of which less than half was measured, over all images.
    doubtful : int
        Images whose result is doubtful or did not converge.
    unit : str
        Unit of the mesh; empty if it is not known.
    """

    square: float
    zero_displacement: Floats
    zero_strain: Floats
    readings: list[Reading]
    along: tuple[Deviations, Deviations]
    rotation: Deviations
    pixel: PixelSize
    checks: list[Check]
    num_poses: int
    not_measured: int
    squares_left_out: int
    doubtful: int
    unit: str

    @property
    def zd(self) -> float:
        """Zero displacement deviation, in the mesh's unit."""
        return float(self.zero_displacement[0])

    @property
    def zs(self) -> float:
        """Zero strain deviation."""
        return float(self.zero_strain[0])

    @property
    def d(self) -> float:
        """Largest displacement deviation along an axis, in the mesh's unit; NaN if no displacement was set."""
        return float(np.max([each.largest for each in self.along]))

    @property
    def within_limits(self) -> bool:
        """Whether no limit is exceeded."""
        return all(check.holds for check in self.checks)

    def summary(self) -> dict[str, Any]:
        """Return the assessment as JSON types.

        Returns
        -------
        dict
            The values by name, None where one is not known.
        """
        return {
            "after": ["EN 4861", "VDI/VDE 2626 Part 1"],
            "conformity": "not claimed",
            "unit": self.unit or None,
            "square": self.square,
            "poses": self.num_poses,
            "images": len(self.readings),
            "zd": dict(zip(("all", "x", "y"), map(_finite, self.zero_displacement), strict=True)),
            "zs": dict(zip(("all", "exx", "eyy", "exy"), map(_finite, self.zero_strain), strict=True)),
            "d": {name: _entries(each) for name, each in zip("xy", self.along, strict=True)},
            "rotation_degrees": _entries(self.rotation),
            "pixel_size": {"size": _finite(self.pixel.size), "uncertainty": _finite(self.pixel.uncertainty)},
            "readings": [
                {
                    "pose": reading.pose,
                    "displacement": [_finite(value) for value in reading.displacement],
                    "rotation_degrees": _finite(reading.rotation),
                    "deviation": [_finite(value) for value in reading.deviation],
                    "rotation_deviation_degrees": _finite(reading.rotation_deviation),
                    "squares": reading.squares,
                }
                for reading in self.readings
            ],
            "limits": [
                {"name": check.name, "value": _finite(check.value), "limit": check.limit, "holds": check.holds}
                for check in self.checks
            ],
            "within_limits": self.within_limits if self.checks else None,
            "nodes_not_measured": self.not_measured,
            "squares_left_out": self.squares_left_out,
            "doubtful_images": self.doubtful,
        }


def _entries(found: Deviations) -> dict[str, Any]:
    return {name: _finite(value) for name, value in found._asdict().items()}


def _finite(value: float) -> float | None:
    if isinstance(value, int):
        return value
    return float(value) if math.isfinite(value) else None
