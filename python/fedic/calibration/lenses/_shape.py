"""Departures of a target from its plan, as unknowns of a calibration that all views share."""

from dataclasses import dataclass

import numpy as np

from fedic._core import Distortion, Pinhole
from fedic._internal.types import Floats
from fedic.calibration.lenses._coefficients import CoefficientLens

__all__ = ["SHAPES", "ShapedTarget"]

SHAPES = ("stretch", "skew", "bend_xx", "bend_xy", "bend_yy")
"""Unknowns of the shape: relative excess of the pitch along Y, shear of X along Y, and the parts of a curvature."""


@dataclass(frozen=True, eq=False)
class ShapedTarget:
    """A `Lens` together with the shape of the target; the unknowns of the shape come last.

    A point (X, Y, 0) of the plan is at (X + skew Y, (1 + stretch) Y, Z), with ``Z = half * (bend_xx x**2 + bend_xy x y
    + bend_yy y**2)``, where x and y are measured from the centre in units of `half`.

    Attributes
    ----------
    lens : CoefficientLens
        Lens model.
    shapes : tuple of str
        Free unknowns among `SHAPES`.
    centre : ndarray, shape (2,)
        Centre of the target.
    half : float
        Half its length.
    """

    lens: CoefficientLens
    shapes: tuple[str, ...]
    centre: Floats
    half: float

    @property
    def name(self) -> str:
        """See `Lens.name`."""
        return self.lens.name

    @property
    def parameters(self) -> tuple[str, ...]:
        """See `Lens.parameters`."""
        return self.lens.parameters

    @property
    def size(self) -> int:
        """Number of unknowns, those of the shape included."""
        return self.lens.size + len(self.shapes)

    @property
    def tolerance(self) -> float:
        """See `Lens.tolerance`."""
        return self.lens.tolerance

    @property
    def first_damping(self) -> float:
        """See `Lens.first_damping`."""
        return self.lens.first_damping

    @property
    def penalty(self) -> None:
        """None: the unknowns are free."""
        return

    def linearised(
        self, values: Floats, rotation: Floats, translation: Floats, points: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Project points of the plan, with derivatives, see `Lens.linearised`."""
        moved = self.shaped(values, points)
        pixels, by_lens, by_pose = self.lens.linearised(self._of_lens(values), rotation, translation, moved)
        by_point = by_pose[:, :, 3:] @ rotation
        by_shape = np.einsum("nij,nkj->nik", by_point, self._moves(points))
        return pixels, np.concatenate([by_lens, by_shape], axis=2), by_pose

    def distortion(self, values: Floats) -> Distortion | None:
        """See `Lens.distortion`."""
        return self.lens.distortion(self._of_lens(values))

    def camera(self, values: Floats, rotation: Floats, translation: Floats) -> Pinhole:
        """See `Lens.camera`."""
        return self.lens.camera(self._of_lens(values), rotation, translation)

    def shaped(self, values: Floats, points: Floats) -> Floats:
        """Return the points (n, 3) of the target for points of the plan."""
        moved: Floats = points + np.einsum("nkj,k->nj", self._moves(points), values[self.lens.size :])
        return moved

    def _of_lens(self, values: Floats) -> Floats:
        return values[: self.lens.size]

    def _moves(self, points: Floats) -> Floats:
        """Return the derivatives (n, k, 3) of the points with respect to the unknowns of the shape."""
        x, y = ((points[:, :2] - self.centre) / self.half).T
        moves = {
            "stretch": (1, points[:, 1]),
            "skew": (0, points[:, 1]),
            "bend_xx": (2, self.half * x * x),
            "bend_xy": (2, self.half * x * y),
            "bend_yy": (2, self.half * y * y),
        }
        found = np.zeros((len(points), len(self.shapes), 3))
        for index, name in enumerate(self.shapes):
            axis, move = moves[name]
            found[:, index, axis] = move
        return found
