"""Points of a target found in an image."""

from dataclasses import dataclass

from fedic._internal.types import Floats

__all__ = ["Observation"]


@dataclass(frozen=True, eq=False)
class Observation:
    """Points of a target and their image points in one view.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        Points of the target, in its frame.
    pixels : ndarray, shape (n, 2)
        Image points.
    """

    points: Floats
    pixels: Floats
