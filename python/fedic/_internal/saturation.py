"""Share of the pixels of an image at its full scale."""

import numpy as np

from fedic._core import full_scale
from fedic._internal.types import Image

__all__ = ["saturated_share"]


def saturated_share(image: Image) -> float:
    """Return the share of pixels at the full scale.

    Parameters
    ----------
    image : ndarray of uint8, uint16 or float32
        The image.

    Returns
    -------
    float
        From 0 to 1.
    """
    full = full_scale(np.ascontiguousarray(image))  # type: ignore[arg-type]
    return 0.0 if full is None else float(np.mean(image == full))
