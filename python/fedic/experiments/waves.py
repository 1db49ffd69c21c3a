"""An analytic texture of plane waves, whose deformed images are exact up to rounding."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats

__all__ = ["CONTRAST", "LONGEST", "SHORTEST", "Waves"]

SHORTEST, LONGEST = 4.5, 14.0
"""Wavelengths in pixels."""
CONTRAST = 40.0
"""Standard deviation of the texture, in grey levels."""
_COUNT = 120
_MEAN = 120.0


class Waves:
    """A sum of plane waves of random wavelength, direction and phase.

    Parameters
    ----------
    seed : int
        Seed of the wavelengths, directions and phases.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        length = rng.uniform(SHORTEST, LONGEST, _COUNT)
        angle, self._phases = rng.uniform(0.0, 2.0 * np.pi, (2, _COUNT))
        self._vectors = 2.0 * np.pi / length[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])

    def image(self, size: int, gradient: Floats, shift: Sequence[float] | Floats = (0.0, 0.0)) -> NDArray[np.float32]:
        """Return an image of the texture, sampled at the centres of the pixels, after an affine deformation.

        Parameters
        ----------
        size : int
            Height and width in pixels.
        gradient : ndarray of float, shape (2, 2)
            Deformation gradient; the centre ``(size / 2, size / 2)`` is fixed.
        shift : (float, float) or ndarray of float, shape (2,)
            Translation along ``u`` and ``v`` in pixels, after the deformation.

        Returns
        -------
        ndarray of float32, shape (size, size)
            Grey levels of mean 120, not rounded to whole levels.
        """
        # The affine image of a plane wave is a plane wave: a product of functions of u and of v.
        vectors = self._vectors @ np.linalg.inv(gradient)
        u, v = (np.arange(size) - size / 2.0 - along for along in shift)
        columns = np.exp(1j * np.outer(vectors[:, 0], u))
        rows = np.exp(1j * (np.outer(v, vectors[:, 1]) + self._phases))
        grey = _MEAN + CONTRAST * np.sqrt(2.0 / _COUNT) * (rows @ columns).real
        return np.asarray(grey, dtype=np.float32)
