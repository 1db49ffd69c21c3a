"""Non-parametric model: a displacement field on the plane of normalised image coordinates (paper, Fig. 12).

The paper fits the field to the residuals of a projective calibration, whose poses have already absorbed a part of the
distortion. Here the field and the poses are unknowns of one least-squares problem, and the field is added to that of
the one radial coefficient of a first fit. A common shift, scale or rotation of the field cannot be distinguished from
another principal point, focal length or rotation of all poses: this rigid part is suppressed by a penalty. Another
penalty, on the fourth differences, smooths the field; its weight is chosen by cross-validation.
"""

from dataclasses import dataclass
from functools import cached_property
from math import comb

import numpy as np

from fedic._core import Distortion, InverseSplineDistortion, Pinhole, SplineDistortion, spline_basis
from fedic._internal.types import Floats
from fedic.calibration.lenses._coefficients import POSE
from fedic.errors import CameraError

__all__ = ["SplineLens"]

_POINTS_PER_COEFFICIENT = 8
_FEWEST_INTERVALS, _MOST_INTERVALS = 4, 16
_MARGIN = 0.005
"""Margin of the domain around the points, relative to their extent: the fit still moves them a little."""
_ORDER = 4
_GRID = 60
_INVERSE_TOLERANCE_PX = 3e-4


@dataclass(frozen=True, eq=False)
class SplineLens:
    """A camera whose lens is a tensor-product cubic B-spline.

    Its unknowns are fx, fy, cx, cy, and the changes of the coefficients of a first lens: of the displacement along x,
    then along y.

    Attributes
    ----------
    name : str
        ``"spline"`` or ``"inverse-spline"``, the form of the lens of the camera.
    domain : (x0, y0, x1, y1)
        Domain in normalised image coordinates.
    intervals : (int, int)
        Numbers of intervals along x and y.
    first : ndarray, shape (number of coefficients, 2)
        Coefficients that approximate the first lens.
    image : (u0, v0, u1, v1)
        Part of the image covered by the points, in pixels: the domain of the inverse form.
    unit : float
        Typical weight of the points on a coefficient, in pixels squared.
    smoothing : float
        Weight of the squared differences in this unit.
    """

    name: str
    domain: tuple[float, float, float, float]
    intervals: tuple[int, int]
    first: Floats
    image: tuple[float, float, float, float]
    unit: float
    smoothing: float = 0.0

    @classmethod
    def over(cls, name: str, points: Floats, pixels: Floats, first: Pinhole) -> "SplineLens":
        """Choose domain and intervals for the points of a calibration.

        Parameters
        ----------
        name : str
            ``"spline"`` or ``"inverse-spline"``.
        points, pixels : ndarray, shape (n, 2)
            Undistorted points in normalised coordinates, and their image points.
        first : Pinhole
            Camera of a first fit.
        """
        domain = _box(points)
        sides = np.subtract(domain[2:], domain[:2])
        density = np.sqrt(len(points) / _POINTS_PER_COEFFICIENT / sides.prod())
        density = np.clip(density, _FEWEST_INTERVALS / sides.min(), None)
        density = min(density, _MOST_INTERVALS / sides.max())
        nx, ny = (max(round(float(side * density)), 1) for side in sides)
        places = _grid(domain)
        basis = spline_basis(domain, (nx, ny), places)[0]
        field = np.zeros_like(places) if first.distortion is None else first.distortion.distort(places) - places
        coefficients = np.linalg.lstsq(basis, field, rcond=None)[0]
        unit = max(first.focal) ** 2 * len(points) / len(coefficients)
        return cls(name, domain, (nx, ny), coefficients, _box(pixels), unit)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the first unknowns."""
        return ("fx", "fy", "cx", "cy")

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 4 + 2 * self._count

    @property
    def tolerance(self) -> float:
        """Half a standard deviation, for hundreds of unknowns: the cost would fall by a quarter of a variance.

        More iterations would be many, since the views hardly determine some combinations of the field and the poses.
        """
        return 0.5

    @property
    def first_damping(self) -> float:
        """Nearly zero: the problem is linear in the field, and the poses come from a first fit."""
        return 1e-9

    @cached_property
    def penalty(self) -> Floats:
        """Matrix (size, size) of the quadratic form that smooths the field and suppresses its rigid part."""
        return self.penalty_of(self.smoothing)

    def penalty_of(self, smoothing: float) -> Floats:
        """Return the penalty for another smoothing."""
        form: Floats = self.unit * (self._rigidity + smoothing * self._roughness)
        return form

    @cached_property
    def _roughness(self) -> Floats:
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
    def _rigidity(self) -> Floats:
        """Matrix (size, size) of a quadratic form of the rigid part of the field.

        Its weight does not matter, since poses and intrinsic parameters can compensate the rigid part exactly.
        """
        places = _grid(self.domain)
        x, y = places.T
        zero, one = np.zeros_like(x), np.ones_like(x)
        fields = [(one, zero), (zero, one), (x, zero), (zero, y), (-y, x), (x * y, 1 + y * y), (1 + x * x, x * y)]
        basis = spline_basis(self.domain, self.intervals, places)[0]
        rigid = np.array([np.concatenate([basis.T @ along, basis.T @ across]) for along, across in fields])
        directions, _ = np.linalg.qr(rigid.T)
        form: Floats = np.zeros((self.size, self.size))
        form[4:, 4:] = directions @ directions.T
        return form

    def linearised(
        self, values: Floats, rotation: Floats, translation: Floats, points: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Project points, with derivatives, see `Lens.linearised`."""
        fx, fy, cx, cy = values[:4]
        count = len(points)
        by_values = np.full((count, 2, self.size), np.nan)
        try:
            camera = self._camera(values, rotation, translation, self.distortion(values))
        except CameraError:
            return by_values[:, :, 0], by_values, by_values[:, :, :6]
        jacobian = camera.parameter_jacobian(points, (*self.parameters, *POSE))
        by_values[:, :, :4] = jacobian[:, :, :4]
        by_values[:, :, 4:] = 0.0
        positions = points @ rotation.T + translation
        basis = spline_basis(self.domain, self.intervals, positions[:, :2] / positions[:, 2:])[0]
        by_values[:, 0, 4 : 4 + self._count] = fx * basis
        by_values[:, 1, 4 + self._count :] = fy * basis
        # Without skew, the derivatives with respect to the focal lengths are the distorted points.
        distorted = np.column_stack([jacobian[:, 0, 0], jacobian[:, 1, 1]])
        return distorted * (fx, fy) + (cx, cy), by_values, jacobian[:, :, 4:]

    def distortion(self, values: Floats) -> SplineDistortion:
        """Return the direct form of the lens for given values of the unknowns."""
        width, height = (count + 3 for count in self.intervals)
        return SplineDistortion(self.domain, self._coefficients(values).T.reshape(height, width, 2))

    def camera(self, values: Floats, rotation: Floats, translation: Floats) -> Pinhole:
        """Return the camera for given values of the unknowns and a pose."""
        fx, fy, cx, cy = (float(value) for value in values[:4])
        lens: Distortion = self.distortion(values)
        if self.name == "inverse-spline":
            u0, v0, u1, v1 = self.image
            domain = ((u0 - cx) / fx, (v0 - cy) / fy, (u1 - cx) / fx, (v1 - cy) / fy)
            try:
                lens = InverseSplineDistortion.from_lens(lens, domain, _INVERSE_TOLERANCE_PX / max(fx, fy))
            except CameraError as fault:
                raise CameraError(
                    f"The lens has no inverse all over the image ({fault}): add views where there are few points, or "
                    "use 'spline'."
                ) from fault
        return self._camera(values, rotation, translation, lens)

    def _camera(self, values: Floats, rotation: Floats, translation: Floats, lens: Distortion) -> Pinhole:
        """Return the camera for given values of the unknowns, a pose and a lens."""
        fx, fy, cx, cy = (float(value) for value in values[:4])
        tx, ty, tz = (float(value) for value in translation)
        return Pinhole((fx, fy), (cx, cy), rotation=rotation, translation=(tx, ty, tz), distortion=lens)

    def _coefficients(self, values: Floats) -> Floats:
        """Return the coefficients (2, number of them) of the displacement."""
        coefficients: Floats = self.first.T + values[4:].reshape(2, -1)
        return coefficients

    @property
    def _count(self) -> int:
        return (self.intervals[0] + 3) * (self.intervals[1] + 3)

    def _of_both(self, field: Floats) -> Floats:
        """Return the quadratic form of all unknowns from that of the coefficients of one component."""
        form = np.zeros((self.size, self.size))
        form[4 : 4 + self._count, 4 : 4 + self._count] = field
        form[4 + self._count :, 4 + self._count :] = field
        return form


def _grid(domain: tuple[float, float, float, float]) -> Floats:
    """Return points (n, 2) of a regular grid over a rectangle, including its borders."""
    x, y = np.meshgrid(np.linspace(domain[0], domain[2], _GRID), np.linspace(domain[1], domain[3], _GRID))
    return np.column_stack([x.ravel(), y.ravel()])


def _box(points: Floats) -> tuple[float, float, float, float]:
    """Return left, top, right and bottom of a rectangle around points (n, 2), with a margin."""
    low, high = points.min(axis=0), points.max(axis=0)
    (x0, y0), (x1, y1) = low - _MARGIN * (high - low), high + _MARGIN * (high - low)
    return float(x0), float(y0), float(x1), float(y1)


def _differences(count: int, order: int) -> Floats:
    """Return the matrix (count - order, count) of differences."""
    return np.diff(np.eye(count), n=order, axis=0)
