"""Normalised cross-correlation of a window with an image."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["correlation_map"]


def correlation_map(image: NDArray[np.float32], window: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the correlation coefficient of a window at each place inside an image; -1 where the image is flat."""
    import cv2

    scores = np.asarray(cv2.matchTemplate(image, window, cv2.TM_CCOEFF_NORMED), dtype=np.float32)
    # Flat areas divide by zero.
    return np.where(np.isfinite(scores) & (np.abs(scores) <= 1.0 + 1e-3), scores, np.float32(-1.0))
