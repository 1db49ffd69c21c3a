"""Sets of options that are compared."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fedic.quadrature import MeshQuadrature, PixelQuadrature, Quadrature

__all__ = ["DEFAULT", "LEGEND", "PAPER", "PAPER_SPLINES", "UNFILTERED", "OptionSet"]


@dataclass(frozen=True)
class OptionSet:
    """A set of options.

    Attributes
    ----------
    name : str
        Name in tables and figures.
    options : mapping
        Options of `fedic.correlate` other than the quadrature; the others have their default.
    mesh : MeshQuadrature
        Mesh quadrature.
    """

    name: str
    options: Mapping[str, Any]
    mesh: MeshQuadrature

    def quadrature(self, kind: str) -> Quadrature:
        """Return the mesh or the pixel quadrature.

        Parameters
        ----------
        kind : {"mesh", "pixel"}
            Kind of quadrature.

        Returns
        -------
        Quadrature
            An option of `fedic.correlate`.
        """
        return self.mesh if kind == "mesh" else PixelQuadrature()


PAPER = OptionSet(
    "paper",
    {"interpolation": "bicubic", "gradient": "finite-difference", "smoothing": 0.0},
    MeshQuadrature(rule="diameter"),
)
"""Options of the paper: bicubic interpolation, finite-difference gradients, diameter rule."""
PAPER_SPLINES = OptionSet(
    "paper, bspline3",
    {"interpolation": "bspline3", "gradient": "finite-difference", "smoothing": 0.0},
    MeshQuadrature(rule="diameter"),
)
"""Options of the paper with cubic B-splines."""
UNFILTERED = OptionSet("unfiltered", {"smoothing": 0.0}, MeshQuadrature())
"""Default options without smoothing: the smallest noise."""
DEFAULT = OptionSet("default", {}, MeshQuadrature())
"""Default options of `fedic.correlate`."""
LEGEND = (
    "*paper*: bicubic interpolation, finite-difference gradients, diameter rule; *paper, bspline3*: the same with "
    "cubic B-splines; *unfiltered*: the default without smoothing; *default*: the default options of `correlate`."
)
"""Legend of the option sets, for the text of an outcome."""
