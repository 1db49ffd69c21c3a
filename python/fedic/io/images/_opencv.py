"""Decoding by OpenCV."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Image
from fedic.io.images._faults import undecodable
from fedic.io.images._levels import luminance

__all__ = ["decode_with_opencv"]


def decode_with_opencv(data: bytes) -> Image:
    """Decode a file that was found complete.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    ndarray of uint8, uint16 or float32, shape (height, width)
        Its grey levels.

    Raises
    ------
    ImageError
        If it is damaged.
    """
    import cv2

    samples: NDArray[Any] | None
    try:
        samples = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise undecodable(error) from error
    if samples is None:
        raise undecodable("OpenCV finds no image in it")
    if samples.ndim == 3 and samples.shape[2] >= 3:
        samples = samples[:, :, 2::-1]
    return luminance(samples)
