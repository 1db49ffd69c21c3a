"""The ways of measuring that are compared."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fedic.quadrature import MeshQuadrature, PixelQuadrature, Quadrature

__all__ = ["DEFAULT", "LEGEND", "PAPER", "PAPER_SPLINES", "UNFILTERED", "OptionSet"]


@dataclass(frozen=True)
class OptionSet:
    """A way of measuring.

    Attributes
    ----------
    name : str
        What it is called in tables and pictures.
    options : mapping
        Options of `fedic.correlate` other than the quadrature; those left out have their default.
    mesh : MeshQuadrature
        Its rule when the points lie in the mesh.
    """

    name: str
    options: Mapping[str, Any]
    mesh: MeshQuadrature

    def quadrature(self, kind: str) -> Quadrature:
        """Return the rule of a kind.

        Parameters
        ----------
        kind : {"mesh", "pixel"}
            Where the points lie.

        Returns
        -------
        Quadrature
            For `fedic.correlate`.
        """
        return self.mesh if kind == "mesh" else PixelQuadrature()


PAPER = OptionSet(
    "paper",
    {"interpolation": "bicubic", "gradient": "finite-difference", "smoothing": 0.0},
    MeshQuadrature(rule="diameter"),
)
"""The paper's own: bicubic interpolation, finite-difference gradients, diameter rule."""
PAPER_SPLINES = OptionSet(
    "paper, bspline3",
    {"interpolation": "bspline3", "gradient": "finite-difference", "smoothing": 0.0},
    MeshQuadrature(rule="diameter"),
)
"""The same with cubic B-splines."""
UNFILTERED = OptionSet("unfiltered", {"smoothing": 0.0}, MeshQuadrature())
"""The default of fedic without its smoothing: the least noise."""
DEFAULT = OptionSet("default", {}, MeshQuadrature())
"""What `fedic.correlate` does when told nothing."""
LEGEND = (
    "*paper*: bicubic interpolation, finite-difference gradients, diameter rule; *paper, bspline3*: the same with "
    "cubic B-splines; *unfiltered*: the default without smoothing; *default*: what `correlate` does when told nothing."
)
"""The settings, for the text of an outcome."""
