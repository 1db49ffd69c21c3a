"""Quadrature of the integral over the mesh."""

from dataclasses import dataclass
from numbers import Real
from typing import TypeAlias, get_args

from fedic import _core
from fedic._internal.choices import check_choice
from fedic._internal.option_choices import QuadratureRule
from fedic.errors import OptionError

__all__ = ["MeshQuadrature", "PixelQuadrature", "Quadrature"]


@dataclass(frozen=True)
class MeshQuadrature:
    """Points spread evenly in each element, in the physical space.

    Each element is cut into equal sub-elements of one point each, so that straight-sided elements integrate their area
    exactly.

    Parameters
    ----------
    density : float
        Factor on the number of points. With 1 the rules below hold: about one point per pixel of the reference image.
    rule : {"rotated", "edges", "diameter"}
        ``"edges"`` gives about one point per pixel of the projected area: a parallelogram is cut, in each direction, by
        the whole pixels of its edge; any other quadrilateral so finely that neighbouring points are at most 1.2 pixels
        apart, 0.85 to 1.5 points per pixel; a triangle into rows of points parallel to its longest edge, a pixel apart.
        ``"rotated"`` takes as many, with the points of a quadrilateral on a grid rotated by a small angle, so that
        sub-pixel phases vary along the element and the interpolation error averages out. ``"diameter"``, the paper's,
        cuts every edge by the largest distance between two nodes, so that every pixel holds a point: at least 2 points
        per pixel in quadrilaterals, 4 in right triangles.

    Raises
    ------
    OptionError
        If the density is not a positive number of at most 10000 or the rule is unknown.
    """

    density: float = 1.0
    rule: QuadratureRule = "rotated"

    def __post_init__(self) -> None:
        check_choice("rule", self.rule, get_args(QuadratureRule))
        if isinstance(self.density, bool) or not isinstance(self.density, Real):
            raise OptionError(f"density must be a positive number, got {self.density!r}", "density")
        _core.check_correlation_options(quadrature=(self.rule, self.density))


@dataclass(frozen=True)
class PixelQuadrature:
    """The classical rule: the pixels whose centre falls in the projected element, each of weight one pixel."""


Quadrature: TypeAlias = MeshQuadrature | PixelQuadrature
