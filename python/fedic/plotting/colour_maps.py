"""Colour maps of the pictures, by what they show."""

__all__ = ["COUNT", "DISTANCE", "IMAGE", "SEQUENTIAL", "SIGNED"]

SIGNED = "RdBu_r"
"""Quantities that are zero in the middle: strains, residuals, errors."""
SEQUENTIAL = "viridis"
"""Quantities of one sign."""
COUNT = "Blues"
"""Numbers of observations."""
DISTANCE = "coolwarm"
"""Signed distances along an edge."""
IMAGE = "gray"
"""Grey levels of an image in the background."""
