"""Textured grey levels and colours of several depths."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_RNG = np.random.default_rng(5)
_V, _U = np.mgrid[:45, :61]
_SHADE = 0.5 + 0.3 * np.sin(_U / 5) * np.cos(_V / 4) + _RNG.uniform(-0.2, 0.2, _V.shape)


def grey(dtype: Any, highest: float) -> NDArray[Any]:
    """Return a textured image with levels from 0 to a highest one."""
    shade = (_SHADE - _SHADE.min()) / np.ptp(_SHADE)
    return (shade * highest).astype(dtype) if np.dtype(dtype).kind == "f" else np.rint(shade * highest).astype(dtype)


def colour(dtype: Any, highest: float) -> NDArray[Any]:
    """Return an image of three colours."""
    image = grey(dtype, highest)
    return np.stack([image, image[::-1], image[:, ::-1]], axis=2)


def luminance(image: NDArray[Any]) -> NDArray[np.float64]:
    """Return the luminance of colours in double precision."""
    return np.asarray(image[:, :, :3].astype(np.float64) @ (0.299, 0.587, 0.114))


G1, G8, G12, G16 = grey(bool, 1), grey(np.uint8, 255), grey(np.uint16, 4095), grey(np.uint16, 65535)
F32 = grey(np.float32, 1000.0) / np.float32(3)
C8, C16 = colour(np.uint8, 255), colour(np.uint16, 65535)
ROUNDING = 1.5
"""Largest difference of OpenCV's luminance, in integers, to the exact one."""
