"""Type aliases shared by several modules."""

import os
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from fedic._core import BrownDistortion, FrontParallel, ImageFrame, InverseSplineDistortion, Pinhole, SplineDistortion

__all__ = ["CELL_NAMES", "NODE_COUNTS", "Camera", "CellName", "Distortion", "Floats", "Image", "StrPath"]

Camera: TypeAlias = ImageFrame | FrontParallel | Pinhole
Distortion: TypeAlias = BrownDistortion | SplineDistortion | InverseSplineDistortion
CellName: TypeAlias = Literal["triangle", "triangle6", "quad", "quad8", "quad9"]
CELL_NAMES: tuple[str, ...] = get_args(CellName)
NODE_COUNTS: dict[str, int] = {"triangle": 3, "triangle6": 6, "quad": 4, "quad8": 8, "quad9": 9}
Floats: TypeAlias = NDArray[np.float64]
Image: TypeAlias = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.float32]
StrPath: TypeAlias = str | os.PathLike[str]
