"""Static images of a speckle with sensor noise, before and after rounding."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

import fedic

__all__ = ["scene", "shot"]


@cache
def scene(
    shape: tuple[int, int] = (300, 300), shift: tuple[float, float] = (0.0, 0.0), size: float = 5.0
) -> NDArray[np.float64]:
    """Return the grey levels of a speckle of 8 bits that has moved by some pixels, neither noisy nor rounded."""
    image = fedic.synthetic.render(
        fedic.synthetic.Speckle(size, seed=3), fedic.ImageFrame(), shape, displacement=shift, bits=16
    )
    return np.asarray(image / 257.0)


def shot(
    image: NDArray[np.float64], seed: int, *, noise: float = 2.0, shot_noise: float = 0.0, gain: float = 1.0
) -> NDArray[np.uint8]:
    """Return what a camera of 8 bits records of a scene."""
    taken = fedic.synthetic.add_noise(gain * image, noise=noise, shot_noise=shot_noise, seed=seed, bits=8)
    assert taken.dtype == np.uint8
    return taken  # type: ignore[return-value]
