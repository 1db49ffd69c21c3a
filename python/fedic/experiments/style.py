"""Colours and markers shared by the figures."""

__all__ = ["COLOURS", "MARKERS"]

COLOURS = {
    ("paper", "pixel"): "tab:red",
    ("paper", "mesh"): "tab:blue",
    ("default", "pixel"): "tab:orange",
    ("default", "mesh"): "tab:green",
}
"""Colours of options and quadrature."""
MARKERS = {"quad": "s", "triangle": "^"}
"""Markers of cell types."""
