"""Where the integral over the mesh is sampled: the two quadrature rules."""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from fedic.errors import SolveError

__all__ = ["MeshQuadrature", "PixelQuadrature", "Quadrature"]


@dataclass(frozen=True)
class MeshQuadrature:
    """Points spread evenly in each element, in the physical space.

    Each element is cut into equal sub-elements of one point each, so that straight-sided elements integrate their area
    exactly.

    Parameters
    ----------
    density : float
        Scales the number of points: 1 is that of the rule, about one point per pixel of the reference image.
    rule : {"rotated", "edges", "diameter"}
        ``"edges"`` cuts each direction of a quadrilateral by the whole pixels in the shorter of its two edges, 0.8 to 1
        point per pixel, and a triangle, whose points lie less evenly, into 1.6 points per pixel. ``"rotated"`` takes as
        many, those of a quadrilateral on a grid turned by a small angle: points a pixel apart keep the same place in
        their pixels all along an element, where the error of the interpolation then does not average out; turned, they
        sweep all places. ``"diameter"``, the paper's, cuts every edge by the largest distance between two nodes, so
        that no pixel is without a point: at least 2 points per pixel in quadrilaterals, 4 in right triangles.

    Raises
    ------
    SolveError
        If the density is not a positive number or the rule is unknown.
    """

    density: float = 1.0
    rule: Literal["rotated", "edges", "diameter"] = "rotated"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.density) and self.density > 0.0):
            raise SolveError(
                f"MeshQuadrature: density is {self.density!r}; give a positive number (1 is one point per pixel)."
            )
        if self.rule not in ("rotated", "edges", "diameter"):
            raise SolveError(f'MeshQuadrature: rule is {self.rule!r}; choose "rotated", "edges" or "diameter".')


@dataclass(frozen=True)
class PixelQuadrature:
    """The classical rule: the pixels whose centre falls in the projected element, each of weight one pixel."""


Quadrature: TypeAlias = MeshQuadrature | PixelQuadrature
