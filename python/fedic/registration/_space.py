"""Points of a plane mesh as points in space."""

import numpy as np

from fedic._internal.types import Floats

__all__ = ["in_space"]


def in_space(points: Floats) -> Floats:
    """Return points (n, 2) or (n, 3) as points (n, 3), with Z = 0 where it is missing."""
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])
