"""Colours and markers that mean the same in every picture."""

__all__ = ["COLOURS", "MARKERS"]

COLOURS = {
    ("paper", "pixel"): "tab:red",
    ("paper", "mesh"): "tab:blue",
    ("default", "pixel"): "tab:orange",
    ("default", "mesh"): "tab:green",
}
"""By setting and quadrature."""
MARKERS = {"quad": "s", "triangle": "^"}
"""By kind of cell."""
