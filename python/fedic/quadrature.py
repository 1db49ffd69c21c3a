"""Where the integral over the mesh is sampled: the two quadrature rules."""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from fedic.errors import SolveError

__all__ = ["MeshQuadrature", "PixelQuadrature", "Quadrature"]


@dataclass(frozen=True)
class MeshQuadrature:
    """Points spread evenly in each element, in the physical space.

    Each element is cut into equal sub-elements whose centres are the points, so that straight-sided elements
    integrate their area exactly.

    Parameters
    ----------
    density : float
        Scales the number of points; 1 aims at one point per pixel of the reference image.
    rule : {"edges", "diameter"}
        ``"edges"`` cuts a quadrilateral by its own two edge lengths in the image. ``"diameter"`` cuts both directions
        by the largest distance between two nodes: twice the points of ``"edges"`` for the same precision.

    Raises
    ------
    SolveError
        If the density is not a positive number or the rule is unknown.
    """

    density: float = 1.0
    rule: Literal["edges", "diameter"] = "edges"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.density) and self.density > 0.0):
            raise SolveError(
                f"MeshQuadrature: density is {self.density!r}; give a positive number (1 is one point per pixel)."
            )
        if self.rule not in ("edges", "diameter"):
            raise SolveError(f'MeshQuadrature: rule is {self.rule!r}; choose "edges" or "diameter".')


@dataclass(frozen=True)
class PixelQuadrature:
    """The classical rule: the pixels whose centre falls in the projected element, each of weight one pixel."""


Quadrature: TypeAlias = MeshQuadrature | PixelQuadrature
