"""Type aliases shared by several modules."""

import os
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._core import FrontParallel, ImageFrame, Pinhole

__all__ = ["Camera", "CellName", "Floats", "Image", "StrPath"]

Camera: TypeAlias = ImageFrame | FrontParallel | Pinhole
CellName: TypeAlias = str
"""Name of a cell type, a key of `fedic.CELL_TYPES`."""
Floats: TypeAlias = NDArray[np.float64]
Image: TypeAlias = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.float32]
StrPath: TypeAlias = str | os.PathLike[str]
