"""Star of the DIC Challenge 2.0, a vertical wave whose period grows along the image, and meshes on it."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fedic._core import ImageFrame, Mesh, rectangle_mesh
from fedic._internal.types import CellName, Floats, Image
from fedic.errors import ImageError
from fedic.synthetic import Speckle, render

__all__ = ["AMPLITUDE", "Star", "StarMesh", "period_at", "real_star", "star_mesh", "synthetic_star", "turned_mesh"]

AMPLITUDE = 0.5
"""Amplitude of the vertical motion, in pixels."""
_SHORTEST_PERIOD, _PERIOD_SLOPE = 10.0, 0.0725
_SHAPE, _QUICK_SHAPE = (501, 4000), (301, 1800)
_CALM_BAND = (0.625, 0.975)
"""Part of the width in which the noise is evaluated: 2500 to 3900 of the 4000 px."""
_EDGE = 2.0
"""Distance between the mesh and the borders of the image, in pixels."""

_SPECKLE, _LEVELS = 4.8, (0.15, 0.757)
_READ_NOISE, _SHOT_NOISE = 0.84, 0.032


@dataclass(frozen=True, eq=False)
class Star:
    """A pair of images of the star.

    Attributes
    ----------
    name : str
        Name in tables and figures.
    reference, deformed : ndarray, shape (height, width)
        The images.
    """

    name: str
    reference: Image
    deformed: Image

    @property
    def middle(self) -> float:
        """Row of the crest, in pixels."""
        return float(self.reference.shape[0] - 1) / 2

    @property
    def width(self) -> int:
        """Columns of the images."""
        return int(self.reference.shape[1])

    @property
    def calm_columns(self) -> Floats:
        """Columns in which the noise is evaluated, of long periods."""
        first, last = (round(part * self.width) for part in _CALM_BAND)
        return np.arange(first + 1.0, last)


@dataclass(frozen=True, eq=False)
class StarMesh:
    """A mesh on the star.

    Attributes
    ----------
    mesh : Mesh
        Mesh in pixels, with nodes on the crest.
    size : float
        Edge of its elements, in pixels.
    reach : float
        Extent above and below the crest, in pixels.
    """

    mesh: Mesh
    size: float
    reach: float


def period_at(columns: Floats) -> Floats:
    """Return the period of the wave at given columns, both in pixels."""
    return _SHORTEST_PERIOD + _PERIOD_SLOPE * columns


@lru_cache(maxsize=1)
def synthetic_star(*, quick: bool) -> Star:
    """Render a pair similar to the real one.

    Speckle, contrast and noise are those estimated from the real pair. Its grey levels have a standard deviation of
    37.8 and a gradient of 19.7 levels per pixel (root mean square of each component). Its noise is estimated from the
    difference between the reference and the deformed image where the motion is below 0.02 px: 2.1 grey levels on
    average in each image, with a variance of ``0.84**2 + 0.032 g`` at grey level ``g``.

    Parameters
    ----------
    quick : bool
        Smaller images with the same wave.

    Returns
    -------
    Star
        Images of 8 bits.
    """
    shape = _QUICK_SHAPE if quick else _SHAPE
    middle = (shape[0] - 1) / 2

    def wave(points: Floats) -> Floats:
        vertical = AMPLITUDE * np.cos(2.0 * np.pi * (points[:, 1] - middle) / period_at(points[:, 0]))
        return np.stack([np.zeros(len(points)), vertical], axis=1)

    def image(seed: int, moved: bool) -> NDArray[np.uint8] | NDArray[np.uint16]:
        return render(
            Speckle(_SPECKLE, seed=3),
            ImageFrame(),
            shape,
            displacement=wave if moved else None,
            levels=_LEVELS,
            noise=_READ_NOISE,
            shot_noise=_SHOT_NOISE,
            seed=seed,
        )

    return Star("synthetic", image(1, moved=False), image(2, moved=True))


def real_star(pair: tuple[Image, Image]) -> Star:
    """Return the published pair.

    Parameters
    ----------
    pair : (ndarray, ndarray)
        Reference and deformed image.

    Returns
    -------
    Star
        The pair.

    Raises
    ------
    ImageError
        If the images do not have the shape of the pair.
    """
    if any(image.shape != _SHAPE for image in pair):
        found = " and ".join("x".join(map(str, image.shape)) for image in pair)
        raise ImageError(
            f"--star: the images are of {found} px (rows x columns); the noisy star pair of the DIC Challenge 2.0 has "
            f"{_SHAPE[0]} x {_SHAPE[1]}."
        )
    return Star("real", *pair)


def star_mesh(star: Star, size: float, cell: CellName, shift: tuple[float, float] = (0.0, 0.0)) -> StarMesh:
    """Make a regular mesh, symmetric about the crest and with a line of nodes on it.

    Parameters
    ----------
    star : Star
        The images.
    size : float
        Edge of the elements, in pixels.
    cell : str
        Cell type.
    shift : (float, float)
        Shift of the mesh to the right and downwards, relative to an element; a shift downwards moves the line of nodes
        off the crest.

    Returns
    -------
    StarMesh
        The mesh.
    """
    left, lowest = _EDGE + shift[0] * size, star.middle - _EDGE
    half = size * ((lowest - abs(shift[1]) * size) // size)
    right = left + size * ((star.width - 3.0 - left) // size)
    centre = star.middle + shift[1] * size
    mesh = rectangle_mesh((left, centre - half, right, centre + half), size, cell)
    return StarMesh(mesh, size, half - abs(shift[1]) * size)


def turned_mesh(star: Star, size: float, cell: CellName, degrees: float) -> StarMesh:
    """Make a regular mesh rotated about a node on the crest, of the elements inside the image.

    Parameters
    ----------
    star : Star
        The images.
    size : float
        Edge of the elements, in pixels.
    cell : str
        Cell type.
    degrees : float
        Angle; at 45 and 135 the diagonals of the elements lie on the crest, with nodes at their ends.

    Returns
    -------
    StarMesh
        The mesh; its upper and lower edges are ragged.
    """
    half = size * math.ceil(star.width / (2.0 * size) + 1.0)
    whole = rectangle_mesh((-half, -half, half, half), size, cell)
    angle = math.radians(degrees)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    points = whole.points @ turn + (star.width / 2, star.middle)
    far = (star.width - 1 - _EDGE, 2.0 * star.middle - _EDGE)
    cells = whole.cells[cell]
    cells = cells[((points >= _EDGE) & (points <= far)).all(axis=1)[cells].all(axis=1)]
    used, renumbered = np.unique(cells, return_inverse=True)
    mesh = Mesh(points[used], {cell: renumbered.reshape(cells.shape)})
    return StarMesh(mesh, size, star.middle - _EDGE - math.sqrt(2.0) * size)
