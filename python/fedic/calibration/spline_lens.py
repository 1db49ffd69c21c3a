"""The non-parametric model: a pure projective camera and a field of displacements on the retinal plane.

It is that of the paper's Fig. 12.

The paper fits the field to what a pure projective calibration leaves. There each pose has already taken its part of the
distortion, another in every view; here the field and the poses are unknowns of one least-squares problem. Nothing tells
a common shift, scale or turn of the field from another principal point, focal length or turn of all poses: this rigid
part is kept out of the field. Fourth differences of the coefficients are penalised, as much as
`fedic.calibration.smoothing` finds right; a lens of one radial coefficient has none.
"""

from dataclasses import dataclass
from functools import cached_property
from math import comb

import numpy as np

from fedic._core import InverseSplineDistortion, Pinhole, SplineDistortion, spline_basis
from fedic._types import Floats

__all__ = ["SplineLens"]

_POINTS_PER_COEFFICIENT = 8
_FEWEST_INTERVALS, _MOST_INTERVALS = 4, 16
_MARGIN = 0.005
"""Of the extent of the points, by which the domain reaches beyond them: they still move a little."""
_ORDER = 4
_RIGID_GRID = 60
_INVERSE_TOLERANCE_PX = 1e-4


@dataclass(frozen=True, eq=False)
class SplineLens:
    """A camera whose lens is a tensor-product cubic B-spline.

    Its unknowns are fx, fy, cx, cy, the coefficients of the displacement along x, and of that along y.

    Attributes
    ----------
    name : str
        ``"spline"`` or ``"inverse-spline"``: what the camera is made with.
    domain : (x0, y0, x1, y1)
        On the retinal plane.
    intervals : (int, int)
        Along x and y.
    unit : float
        What the points weigh on a coefficient, about: pixels squared.
    smoothing : float
        Weight of the squared differences, in this unit.
    """

    name: str
    domain: tuple[float, float, float, float]
    intervals: tuple[int, int]
    unit: float
    smoothing: float = 0.0

    @classmethod
    def over(cls, name: str, points: Floats, focal: float) -> "SplineLens":
        """Choose domain and intervals for the retinal points (n, 2) of a calibration and a focal length in pixels."""
        low, high = points.min(axis=0), points.max(axis=0)
        low, high = low - _MARGIN * (high - low), high + _MARGIN * (high - low)
        sides = high - low
        density = np.sqrt(len(points) / _POINTS_PER_COEFFICIENT / sides.prod())
        density = np.clip(density, _FEWEST_INTERVALS / sides.min(), None)
        density = min(density, _MOST_INTERVALS / sides.max())
        nx, ny = (max(round(float(side * density)), 1) for side in sides)
        unit = focal**2 * len(points) / ((nx + 3) * (ny + 3))
        return cls(name, (float(low[0]), float(low[1]), float(high[0]), float(high[1])), (nx, ny), unit)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the unknowns that have one."""
        return ("fx", "fy", "cx", "cy")

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 4 + 2 * self._count

    @property
    def tolerance(self) -> float:
        """Of hundreds of unknowns together: the sum of squares would fall by a quarter of a coordinate's variance.

        To go on takes many iterations, since the views hardly determine some combinations of the field and the poses.
        """
        return 0.5

    @property
    def first_damping(self) -> float:
        """Next to none: the field is linear, and the poses come from another fit."""
        return 1e-9

    @cached_property
    def penalty(self) -> Floats:
        """Matrix (size, size) of the quadratic form that smooths the field and keeps its rigid part out."""
        form: Floats = self.unit * (self.rigidity + self.smoothing * self.roughness)
        return form

    @cached_property
    def roughness(self) -> Floats:
        """Matrix (size, size) of the sum of the squared differences of fourth order, in all directions."""
        width, height = (count + 3 for count in self.intervals)
        field = np.zeros((self._count, self._count))
        for along in range(_ORDER + 1):
            across = _ORDER - along
            if along < width and across < height:
                rows = np.kron(_differences(height, across), _differences(width, along))
                field += comb(_ORDER, along) * rows.T @ rows
        return self._of_both(field)

    @cached_property
    def rigidity(self) -> Floats:
        """Matrix (size, size) of a quadratic form that only the rigid part of the field feels.

        The data do not feel it where poses and intrinsic parameters follow, so that its weight does not matter.
        """
        x0, y0, x1, y1 = self.domain
        grid = np.stack(np.meshgrid(np.linspace(x0, x1, _RIGID_GRID), np.linspace(y0, y1, _RIGID_GRID)), axis=-1)
        x, y = grid.reshape(-1, 2).T
        zero, one = np.zeros_like(x), np.ones_like(x)
        fields = [(one, zero), (zero, one), (x, zero), (zero, y), (-y, x), (x * y, 1 + y * y), (1 + x * x, x * y)]
        basis = spline_basis(self.domain, self.intervals, grid.reshape(-1, 2))[0]
        rigid = np.array([np.concatenate([basis.T @ along, basis.T @ across]) for along, across in fields])
        directions, _ = np.linalg.qr(rigid.T)
        form: Floats = np.zeros((self.size, self.size))
        form[4:, 4:] = directions @ directions.T
        return form

    def linearised(self, values: Floats, positions: Floats) -> tuple[Floats, Floats, Floats]:
        """Project points of the camera frame, see `Lens.linearised`."""
        fx, fy, cx, cy = values[:4]
        along, across = values[4 : 4 + self._count], values[4 + self._count :]
        depth = positions[:, 2:]
        retinal = positions[:, :2] / depth
        basis, by_x, by_y = spline_basis(self.domain, self.intervals, retinal)
        field = np.column_stack([basis @ along, basis @ across])
        seen = retinal + field
        slopes = np.eye(2) + np.stack(
            [np.column_stack([by_x @ along, by_y @ along]), np.column_stack([by_x @ across, by_y @ across])], axis=1
        )
        slopes *= np.array([[fx], [fy]])
        count = len(positions)
        by_values = np.zeros((count, 2, self.size))
        by_values[:, 0, 0], by_values[:, 1, 1] = seen.T
        by_values[:, 0, 2] = by_values[:, 1, 3] = 1.0
        by_values[:, 0, 4 : 4 + self._count] = fx * basis
        by_values[:, 1, 4 + self._count :] = fy * basis
        of_depth = -np.einsum("nij,nj->ni", slopes, retinal)[:, :, np.newaxis]
        by_positions = np.concatenate([slopes, of_depth], axis=2) / depth[:, :, np.newaxis]
        return seen * (fx, fy) + (cx, cy), by_values, by_positions

    def camera(self, values: Floats, rotation: Floats, translation: Floats) -> Pinhole:
        """Make the camera of some values of the unknowns and a pose."""
        fx, fy, cx, cy = (float(value) for value in values[:4])
        tx, ty, tz = (float(value) for value in translation)
        width, height = (count + 3 for count in self.intervals)
        direct = SplineDistortion(self.domain, np.moveaxis(values[4:].reshape(2, height, width), 0, -1))
        inverse = self.name == "inverse-spline"
        tolerance = _INVERSE_TOLERANCE_PX / max(fx, fy)
        return Pinhole(
            (fx, fy),
            (cx, cy),
            rotation=rotation,
            translation=(tx, ty, tz),
            distortion=InverseSplineDistortion.from_lens(direct, tolerance=tolerance) if inverse else direct,
        )

    @property
    def _count(self) -> int:
        return (self.intervals[0] + 3) * (self.intervals[1] + 3)

    def _of_both(self, field: Floats) -> Floats:
        """Return a quadratic form of all unknowns from one of the coefficients of one component."""
        form = np.zeros((self.size, self.size))
        form[4 : 4 + self._count, 4 : 4 + self._count] = field
        form[4 + self._count :, 4 + self._count :] = field
        return form


def _differences(count: int, order: int) -> Floats:
    """Return the matrix (count - order, count) of differences."""
    return np.diff(np.eye(count), n=order, axis=0)
