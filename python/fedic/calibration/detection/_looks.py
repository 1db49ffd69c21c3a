"""What the points of a pattern look like: crossings of a chessboard and discs.

A look tells which places of an image show a point of the pattern, from the grey levels around them in the steps of the
pattern: the levels of the four squares around a crossing, or the likeness to the mean picture of the discs.
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats, Image
from fedic.calibration.detection._lattice import Lattice, Spots

__all__ = ["Crossings", "Discs", "Look"]

_QUADRANT = np.array([0.15, 0.25, 0.35])
_WEAKEST = 0.3
_UNEVEN = 0.6
_PATCH = 15
_FARTHEST = 0.3
_LIKENESS = 0.93
_LEAST_LIKENESS = 0.75
_CONTRASTS = (0.4, 2.5)


class Look(Protocol):
    """The look of the points of a pattern."""

    def shown(self, spots: Spots) -> tuple[Floats, Floats]:
        """Tell which places show a point.

        Parameters
        ----------
        spots : Spots
            Places.

        Returns
        -------
        ndarray, shape (n,)
            1 where there is a point, 0 where there is none, NaN where the place is not whole in the image.
        ndarray, shape (n, 2)
            The image points, nearer to the points shown.
        """

    def regular(self, lattice: Lattice) -> bool:
        """Tell whether nothing of the pattern lies between the points of a lattice."""


class Crossings:
    """Crossings of the edges of a chessboard, whose sign alternates from place to place.

    Parameters
    ----------
    grey : ndarray, shape (height, width)
        The image.
    lattice : Lattice
        Points that are taken as crossings.
    """

    def __init__(self, grey: Image, lattice: Lattice) -> None:
        self._grey = np.asarray(grey, dtype=np.float32)
        strengths = self._strengths(lattice.spots)[0]
        self._strength = float(np.nanmedian(strengths)) if np.isfinite(strengths).any() else 0.0

    def shown(self, spots: Spots) -> tuple[Floats, Floats]:
        """Tell which places show a crossing, see `Look`."""
        strengths, unevenness = self._strengths(spots)
        relative = strengths / self._strength if self._strength else np.zeros_like(strengths)
        is_shown = (relative > _WEAKEST) & (unevenness < _UNEVEN * np.abs(strengths))
        shown = np.where(np.isfinite(strengths), is_shown.astype(np.float64), np.nan)
        return shown, self._refined(spots, is_shown)

    def regular(self, lattice: Lattice) -> bool:
        """Tell whether each cell of a lattice is of one level, see `Look`."""
        cells = lattice.midway()[2]
        ticks = np.linspace(-0.3, 0.3, 5)
        offsets = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
        levels = _sampled(self._grey, cells, offsets)
        # The strength is the difference of two neighbouring cells, and half of it the deviation in a mixed one.
        known = np.isfinite(levels).all(axis=1)
        return bool(known.any() and np.median(levels[known].std(axis=1)) < 0.25 * abs(self._strength))

    def _strengths(self, spots: Spots) -> tuple[Floats, Floats]:
        """Return the signed differences of the squares at each place, and the unevenness of opposite squares."""
        means = []
        for x_sign, y_sign in ((1, 1), (-1, -1), (1, -1), (-1, 1)):
            grid = np.stack(np.meshgrid(x_sign * _QUADRANT, y_sign * _QUADRANT), axis=-1).reshape(-1, 2)
            means.append(_sampled(self._grey, spots, grid).mean(axis=1))
        first, second, third, fourth = means
        sign = 1.0 - 2.0 * (spots.places.sum(axis=1) % 2)
        return (
            0.5 * sign * (first + second - third - fourth),
            np.maximum(np.abs(first - second), np.abs(third - fourth)),
        )

    def _refined(self, spots: Spots, is_shown: NDArray[np.bool_]) -> Floats:
        import cv2

        pixels: Floats = spots.pixels.copy()
        if is_shown.any():
            step = float(np.nanmin(np.linalg.norm(spots.frames[is_shown], axis=1)))
            half = int(np.clip(0.3 * step, 2, 10))
            start = pixels[is_shown].astype(np.float32).reshape(-1, 1, 2)
            found = cv2.cornerSubPix(self._grey.astype(np.uint8), start, (half, half), (-1, -1), (3, 20, 0.01))
            pixels[is_shown] = found.reshape(-1, 2)
        return pixels


class Discs:
    """Discs of one size and grey level.

    Parameters
    ----------
    grey : ndarray, shape (height, width)
        The image.
    lattice : Lattice
        Points that are taken as centres of discs.
    """

    def __init__(self, grey: Image, lattice: Lattice) -> None:
        self._grey = np.asarray(grey, dtype=np.float32)
        half = 0.5 if lattice.stride == 1 else 0.7
        ticks = np.linspace(-half, half, _PATCH)
        self._offsets = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
        radii = np.linalg.norm(self._offsets, axis=1)
        self._core, self._rim = radii < 0.3 * half, radii > 0.9 * half
        patches, contrasts, _ = self._patches(lattice.spots)
        self._contrast = float(np.nanmedian(contrasts)) if np.isfinite(contrasts).any() else np.nan
        known = np.isfinite(patches).all(axis=1)
        picture = np.median(patches[known], axis=0) if known.any() else np.zeros(_PATCH**2)
        self._picture: Floats = np.asarray(picture, dtype=np.float64)
        own = self._likeness(patches)[known]
        typical = float(np.median(own)) if known.any() else 1.0
        self._limit = max(_LIKENESS * typical, _LEAST_LIKENESS)

    def shown(self, spots: Spots) -> tuple[Floats, Floats]:
        """Tell which places show a disc, see `Look`."""
        patches, contrasts, pixels = self._patches(spots)
        relative = contrasts / self._contrast
        is_shown = (relative > _CONTRASTS[0]) & (relative < _CONTRASTS[1]) & (self._likeness(patches) > self._limit)
        return np.where(np.isfinite(contrasts), is_shown.astype(np.float64), np.nan), pixels

    def regular(self, lattice: Lattice) -> bool:
        """Tell whether there are no discs halfway between those of a lattice, see `Look`."""
        return not any(
            len(between.pixels) and np.mean(self.shown(between)[0] == 1.0) > 0.5 for between in lattice.midway()
        )

    def _likeness(self, patches: Floats) -> Floats:
        """Return the correlation of patches with the mean picture."""
        centred = patches - patches.mean(axis=1, keepdims=True)
        picture = self._picture - self._picture.mean()
        lengths = np.linalg.norm(centred, axis=1) * np.linalg.norm(picture)
        likeness: Floats = centred @ picture / np.where(lengths > 0.0, lengths, np.inf)
        return likeness

    def _patches(self, spots: Spots) -> tuple[Floats, Floats, Floats]:
        """Return the grey levels around the discs (n, m) from 0 to 1, the contrasts (n,) and the centres (n, 2)."""
        moved = spots
        for _ in range(3):
            levels = _sampled(self._grey, moved, self._offsets)
            ground = np.median(levels[:, self._rim], axis=1)
            contrast = np.median(levels[:, self._core], axis=1) - ground
            scale = np.where(contrast != 0.0, contrast, np.inf)
            cover = np.clip((levels - ground[:, np.newaxis]) / scale[:, np.newaxis], 0.0, 1.0)
            sums = cover.sum(axis=1)
            shift = (cover @ self._offsets) / np.where(sums > 0.0, sums, np.inf)[:, np.newaxis]
            pixels = moved.pixels + np.einsum("nij,nj->ni", spots.frames, shift)
            away = np.linalg.solve(spots.frames, (pixels - spots.pixels)[:, :, np.newaxis])[:, :, 0]
            near = np.linalg.norm(away, axis=1) < _FARTHEST
            moved = spots.moved(np.where(near[:, np.newaxis], pixels, moved.pixels))
        return (levels - ground[:, np.newaxis]) / scale[:, np.newaxis], contrast, moved.pixels


def _sampled(grey: NDArray[np.float32], spots: Spots, offsets: Floats) -> Floats:
    """Return grey levels (n, m) at offsets (m, 2) in steps of the pattern; NaN for places not whole in the image."""
    import cv2

    places = spots.pixels[:, np.newaxis] + np.einsum("nij,mj->nmi", spots.frames, offsets)
    height, width = grey.shape
    inside = (
        np.isfinite(places).all(axis=(1, 2))
        & (places >= 0.0).all(axis=(1, 2))
        & (places <= [width - 1.0, height - 1.0]).all(axis=(1, 2))
    )
    levels = np.full(places.shape[:2], np.nan)
    if inside.any():
        at = places[inside].astype(np.float32)
        levels[inside] = cv2.remap(grey, at[:, :, 0], at[:, :, 1], cv2.INTER_LINEAR)
    return levels
