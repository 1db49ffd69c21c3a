"""Reference images of the experiments, and unstructured meshes on them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from fedic._core import ImageFrame, Mesh
from fedic._internal.types import CellName, Image
from fedic.demo.scene import LEVELS, SPECKLE
from fedic.errors import ImageError
from fedic.experiments.outcome import Request
from fedic.meshing import unstructured_mesh
from fedic.synthetic import Speckle, fourier_shift, render

__all__ = ["SIZES", "ReferenceImage", "Window", "pixel_mesh", "reference_images", "window_mesh"]

Window: TypeAlias = tuple[float, float, float, float]
"""Left, top, right and bottom of the mesh, in pixels."""

SIZES = (4, 6, 8, 10, 12, 15, 20, 25, 30)
"""Edges of the elements, in pixels, of Fig. 7 and 14."""

_WIDTH, _HEIGHT = 220.4, 320.6
"""Size of the mesh in pixels; like its corners, not a whole number."""
_CORNER = (0.3, 0.7)
_MARGIN = 40
"""Margin around the mesh in pixels."""
_PATCH = 21
"""Side in pixels of the squares in which the texture is evaluated."""


@dataclass(frozen=True, eq=False)
class ReferenceImage:
    """A reference image and the position of the mesh in it.

    Attributes
    ----------
    name : str
        Name in tables and figures.
    image : ndarray, shape (height, width)
        The whole image.
    left, top : int
        First pixel of the window of the mesh.
    """

    name: str
    image: Image
    left: int
    top: int

    @property
    def window(self) -> Window:
        """Bounds of the mesh in the cropped images."""
        u, v = _MARGIN + _CORNER[0], _MARGIN + _CORNER[1]
        return u, v, u + _WIDTH, v + _HEIGHT

    @property
    def reference(self) -> NDArray[np.float32]:
        """The image around the window."""
        return self._cropped(self.image.astype(np.float32))

    def shifted(self, shift: tuple[float, float]) -> NDArray[np.float32]:
        """Translate the image in the Fourier domain, not rounded, and crop it around the window.

        Parameters
        ----------
        shift : (float, float)
            Motion along columns and rows, in pixels.

        Returns
        -------
        ndarray of float32
            The image, of the shape of `reference`.
        """
        return self._cropped(fourier_shift(self.image, shift))

    def _cropped(self, image: NDArray[np.float32]) -> NDArray[np.float32]:
        rows = slice(self.top - _MARGIN, self.top + round(_HEIGHT) + _MARGIN)
        columns = slice(self.left - _MARGIN, self.left + round(_WIDTH) + _MARGIN)
        return np.ascontiguousarray(image[rows, columns])


def reference_images(request: Request) -> list[ReferenceImage]:
    """Return the synthetic image and, if one is given, the real one.

    Parameters
    ----------
    request : Request
        Request, with or without a real image.

    Returns
    -------
    list of ReferenceImage
        The synthetic one first.
    """
    found = [_synthetic()]
    if request.image is not None:
        found.append(_real(request.image))
    return found


def window_mesh(window: Window, size: float, cell: CellName) -> Mesh:
    """Make the unstructured mesh of a window.

    Parameters
    ----------
    window : tuple
        Left, top, right and bottom, in pixels.
    size : float
        Edge of the elements.
    cell : str
        Cell type.

    Returns
    -------
    Mesh
        Mesh in pixels.
    """
    left, top, right, bottom = window
    return pixel_mesh(((left, top), (right, top), (right, bottom), (left, bottom)), size, cell)


@lru_cache(maxsize=64)
def pixel_mesh(corners: Sequence[tuple[float, float]], size: float, cell: CellName) -> Mesh:
    """Make an unstructured mesh of a polygon; the result is cached.

    Parameters
    ----------
    corners : sequence of (float, float)
        Corners in order, hashable.
    size : float
        Edge of the elements, in the unit of the corners.
    cell : str
        Cell type.

    Returns
    -------
    Mesh
        The mesh.
    """
    return unstructured_mesh(corners, size=size, cell=cell)


def _synthetic() -> ReferenceImage:
    shape = (round(_HEIGHT) + 4 * _MARGIN, round(_WIDTH) + 4 * _MARGIN)
    texture = Speckle(SPECKLE, seed=0)
    image = render(texture, ImageFrame(), shape, levels=LEVELS)
    return ReferenceImage("synthetic", image, 2 * _MARGIN, 2 * _MARGIN)


def _real(image: Image) -> ReferenceImage:
    """Choose the window whose poorest texture is best."""
    height, width = image.shape
    need_u, need_v = round(_WIDTH) + 2 * _MARGIN, round(_HEIGHT) + 2 * _MARGIN
    if width < need_u or height < need_v:
        raise ImageError(
            f"The experiment needs an image of at least {need_u} x {need_v} px (columns x rows), for a mesh of "
            f"{_WIDTH} x {_HEIGHT} px with a margin; this one has {width} x {height}."
        )
    grey = image.astype(np.float32)
    slopes = [cv2.Sobel(grey, cv2.CV_32F, along_u, 1 - along_u) for along_u in (0, 1)]
    texture = cv2.boxFilter(slopes[0] ** 2 + slopes[1] ** 2, cv2.CV_32F, (_PATCH, _PATCH))
    window = np.ones((round(_HEIGHT), round(_WIDTH)), dtype=np.uint8)
    poorest = cv2.erode(texture, window, anchor=(0, 0))
    inside = poorest[_MARGIN : height - round(_HEIGHT) - _MARGIN + 1, _MARGIN : width - round(_WIDTH) - _MARGIN + 1]
    row, column = np.unravel_index(int(np.argmax(inside)), inside.shape)
    return ReferenceImage("real", image, _MARGIN + int(column), _MARGIN + int(row))
