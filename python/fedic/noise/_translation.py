"""Whole-pixel translation between two images, by cross-correlation of their gradients."""

import numpy as np

from fedic._internal.types import Floats

__all__ = ["whole_pixel_shift"]

_SIDE = 1024
"""Largest side of the window that is compared, in pixels."""
_SIGNIFICANCE = 8.0
_LEAST_CORRELATION = 0.1


def whole_pixel_shift(first: Floats, second: Floats) -> tuple[int, int]:
    """Find the translation by whole pixels at which two images resemble each other most.

    Parameters
    ----------
    first, second : ndarray, shape (height, width)
        Grey levels.

    Returns
    -------
    (int, int)
        Pixels to the right and downwards by which the second has moved; (0, 0) unless the correlation of the gradients
        is at least 0.1 at another translation and higher there by eight times its scatter.
    """
    a, b = (_gradient(_window(image)) for image in (first, second))
    shape = [2 * length for length in a.shape]
    products = np.fft.ifft2(np.fft.fft2(a, shape).conj() * np.fft.fft2(b, shape)).real
    scatter = 1.4826 * float(np.median(np.abs(products)))
    v, u = np.unravel_index(int(np.argmax(products)), products.shape)
    energy = np.sqrt(np.vdot(a, a).real * np.vdot(b, b).real)
    if products[v, u] <= max(products[0, 0] + _SIGNIFICANCE * scatter, _LEAST_CORRELATION * energy):
        return 0, 0
    height, width = products.shape
    return int((u + width // 2) % width - width // 2), int((v + height // 2) % height - height // 2)


def _window(image: Floats) -> Floats:
    height, width = image.shape
    top, left = max(0, (height - _SIDE) // 2), max(0, (width - _SIDE) // 2)
    return image[top : top + _SIDE, left : left + _SIDE]


def _gradient(image: Floats) -> "np.ndarray[tuple[int, int], np.dtype[np.complex128]]":
    """Return the derivatives along u and v as real and imaginary part."""
    return 0.5 * (image[1:-1, 2:] - image[1:-1, :-2]) + 0.5j * (image[2:, 1:-1] - image[:-2, 1:-1])
