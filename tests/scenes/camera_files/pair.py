"""The pair of cameras that all files describe."""

from typing import Any

import cv2
import numpy as np

import fedic

FX, FY, CX, CY = 1200.0, 1195.0, 318.25, 243.5
K1, K2, K3, P1, P2 = -0.12, 0.31, 0.05, 0.0011, -0.0007
"""Coefficients of the lens in OpenCV's notation."""
SIZE = (640, 480)
ANGLES = (0.4, -18.0, 1.1)
"""Angles of the second camera relative to the first about x, y, z in degrees, in this order about fixed axes."""
SHIFT = (130.75, -0.6, 17.1)
K = np.array([[FX, 0, CX], [0, FY, CY], [0, 0, 1]])


def turn(angles: tuple[float, float, float]) -> Any:
    """Return the rotation matrix of angles in degrees about the fixed axes x, y, z."""
    x, y, z = (cv2.Rodrigues(np.radians(angle) * axis)[0] for angle, axis in zip(angles, np.eye(3), strict=True))
    return z @ y @ x


R = turn(ANGLES)


def truth(
    *, second: bool = False, k3: float = 0.0, tangential: bool = True, size: Any = SIZE, lens: bool = True
) -> Any:
    """Return the camera that a file should give."""
    model = fedic.BrownDistortion((K1, K2, k3), (P1, P2) if tangential else (0.0, 0.0)) if lens else None
    pose: Any = {"rotation": R, "translation": SHIFT} if second else {}
    return fedic.Pinhole((FX, FY), (CX, CY), distortion=model, image_size=size, **pose)


def listed(values: Any) -> str:
    """Return numbers as a list."""
    return str([float(value) for value in np.ravel(values)])
