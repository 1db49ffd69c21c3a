"""Difference of two images explained by light and motion, tile by tile; what is left is noise."""

import itertools
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.noise._gradient import MARGIN, gradient

__all__ = ["TileFit", "changed_tiles", "fit_tiles", "inner"]

_Value = TypeVar("_Value", bound=np.generic)
_TILE = 40
"""Side of a tile in pixels, about."""
_LIGHT, _MOTION = 6, 2
_UNKNOWNS = _LIGHT + _MOTION
_FEWEST_PIXELS = 8 * _UNKNOWNS
_CHANGED = 2.0
"""Variance of a tile relative to the median tile from which on something else than the noise has changed."""
_RIDGE = 1e-12
"""Keeps the equations of a tile without texture solvable; the regressors are of the order of one."""


@dataclass(frozen=True)
class TileFit:
    """A least-squares fit of the difference of two images in each tile.

    Attributes
    ----------
    residual : ndarray, shape (height - 6, width - 6)
        Difference without what light and motion explain; NaN at pixels that were not used.
    freedom : ndarray, same shape
        Share of its variance that the fit of the tile leaves to the residual.
    motion_squares : float
        Sum of the squares that the motion explains beyond the light.
    residual_squares : float
        Sum of the squares that are left.
    tiles, pixels : int
        Number of tiles and of pixels used.
    energy : ndarray, shape (2, 2)
        Sum of the products of the gradient, without the part that is like a change of light.
    moment : ndarray, shape (2,)
        Sum of the products of gradient and difference.
    """

    residual: Floats
    freedom: Floats
    motion_squares: float
    residual_squares: float
    tiles: int
    pixels: int
    energy: Floats
    moment: Floats

    @property
    def variance(self) -> float:
        """Variance of the difference, in squared grey levels, without light and motion."""
        return self.residual_squares / max(1, self.pixels - _UNKNOWNS * self.tiles)

    @property
    def motion_variance(self) -> float:
        """Variance that the motion adds to the difference: zero on average, and not above it, for images at rest."""
        return (self.motion_squares - _MOTION * self.tiles * self.variance) / max(1, self.pixels)

    @property
    def motion_score(self) -> float:
        """Excess of the squares explained by the motion, in standard deviations of images at rest."""
        expected = _MOTION * self.tiles
        if not self.tiles or self.variance == 0.0:
            return 0.0
        return float((self.motion_squares / self.variance - expected) / np.sqrt(2.0 * expected))


def inner(values: NDArray[_Value]) -> NDArray[_Value]:
    """Return the part of an image that has a gradient."""
    return values[MARGIN:-MARGIN, MARGIN:-MARGIN]


def _tile_edges(length: int) -> NDArray[np.int64]:
    """Return the pixels at which tiles begin, and the end of the last."""
    return np.linspace(0, length, max(1, round(length / _TILE)) + 1).astype(np.int64)


def fit_tiles(first: Floats, second: Floats, used: NDArray[np.bool_]) -> TileFit:
    """Explain the difference of two images in each tile by a gain and an offset linear in space, and a translation.

    The regressors are the mean of both images and its gradient: the noise of the mean is not correlated with that of
    the difference, so that it makes the gain and the translation somewhat too small, but does not make up any.

    Parameters
    ----------
    first, second : ndarray, shape (height, width)
        Grey levels.
    used : ndarray of bool, shape (height, width)
        Pixels to use.

    Returns
    -------
    TileFit
        The fit.
    """
    mean = 0.5 * (first + second)
    slopes = gradient(mean)
    mean, difference, used = inner(mean), inner(second - first), inner(used)
    residual, freedom = np.full(mean.shape, np.nan), np.full(mean.shape, np.nan)
    motion_squares = residual_squares = 0.0
    tiles = pixels = 0
    energy, moment = np.zeros((2, 2)), np.zeros(2)
    rows, columns = (_tile_edges(length) for length in mean.shape)
    for top, bottom in itertools.pairwise(rows):
        for left, right in itertools.pairwise(columns):
            tile = np.s_[top:bottom, left:right]
            mask = used[tile]
            count = int(np.count_nonzero(mask))
            if count < _FEWEST_PIXELS:
                continue
            regressors = _regressors(mean[tile], slopes[0][tile], slopes[1][tile], mask)
            values = difference[tile][mask]
            triangle = np.linalg.cholesky(regressors.T @ regressors + _RIDGE * count * np.eye(_UNKNOWNS)).T
            shares = np.linalg.solve(triangle.T, regressors.T @ values)
            left_over = values - regressors @ np.linalg.solve(triangle, shares)
            residual[tile][mask] = left_over
            freedom[tile][mask] = 1.0 - _UNKNOWNS / count
            motion_squares += float((shares[_LIGHT:] ** 2).sum())
            residual_squares += float((left_over**2).sum())
            block = triangle[_LIGHT:, _LIGHT:]
            energy += block.T @ block
            moment += block.T @ shares[_LIGHT:]
            tiles, pixels = tiles + 1, pixels + count
    return TileFit(residual, freedom, motion_squares, residual_squares, tiles, pixels, energy, moment)


def changed_tiles(relative: Floats) -> tuple[int, int]:
    """Count the tiles whose variance is far above that of the others.

    Parameters
    ----------
    relative : ndarray, shape (height, width)
        Variance of each pixel relative to that expected at its grey level; NaN at pixels that were not used.

    Returns
    -------
    (int, int)
        Tiles with more than twice the variance of the median tile, and tiles.
    """
    rows, columns = (_tile_edges(length) for length in relative.shape)
    means = []
    for top, bottom in itertools.pairwise(rows):
        for left, right in itertools.pairwise(columns):
            tile = relative[top:bottom, left:right]
            known = tile[np.isfinite(tile)]
            if len(known) >= _FEWEST_PIXELS:
                # The scatter of a mean of n squares of normal numbers is sqrt(2 / n).
                means.append(known.mean() / (1.0 + 6.0 * np.sqrt(2.0 / len(known))))
    limit = _CHANGED * float(np.median(means)) if means else np.inf
    return int(np.count_nonzero(np.array(means) > limit)), len(means)


def _regressors(mean: Floats, slope_u: Floats, slope_v: Floats, mask: NDArray[np.bool_]) -> Floats:
    """Return the columns 1, u, v, f, u f, v f, df/du and df/dv at the pixels of a tile."""
    v, u = np.indices(mean.shape).reshape(2, *mean.shape)
    u, v = (2.0 * (place[mask] + 0.5) / length - 1.0 for place, length in ((u, mean.shape[1]), (v, mean.shape[0])))
    grey = mean[mask] - mean[mask].mean()
    unit = grey / max(float(grey.std()), np.finfo(float).tiny)
    return np.column_stack([np.ones_like(grey), u, v, unit, u * unit, v * unit, slope_u[mask], slope_v[mask]])
