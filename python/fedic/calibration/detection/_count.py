"""Checks that the points found are the whole pattern: none missing between them, none beyond their border."""

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats, Image
from fedic.calibration.detection._lattice import SIDES, Lattice, lattice_of
from fedic.calibration.detection._looks import Crossings, Discs, Look
from fedic.calibration.target import Target

__all__ = ["grown_pattern", "is_pattern", "trimmed"]

_MOST = 0.8
_LARGEST_MISFIT = 0.2
_HALF = 0.5
_FEWEST_BEYOND = 2
_LONGEST_GROWTH = 60


def is_pattern(grey: Image, target: Target, pixels: Floats) -> bool:
    """Tell whether all points look alike, with nothing of the pattern between them.

    Parameters
    ----------
    grey : ndarray, shape (height, width)
        The image.
    target : Target
        The target.
    pixels : ndarray, shape (n, 2)
        Points found, row by row.

    Returns
    -------
    bool
        True for a regular pattern. A few points may be hidden, by glare or dirt, but not most of a line at the border.
    """
    lattice = lattice_of(target, pixels)
    if not lattice.misfit < _LARGEST_MISFIT:
        return False
    look = _look(grey, target, lattice)
    shown = look.shown(lattice.spots)[0]
    seen = np.isfinite(shown)
    if not seen.any() or shown[seen].mean() < _MOST:
        return False
    lines = [_line(lattice, side) for side in SIDES]
    return all((shown[line][seen[line]] > 0).mean() > _HALF for line in lines if seen[line].any()) and look.regular(
        lattice
    )


def grown_pattern(grey: Image, target: Target, pixels: Floats) -> Lattice:
    """Return the points found with the lines of the pattern that are seen beyond them.

    Parameters
    ----------
    grey : ndarray, shape (height, width)
        The image.
    target : Target
        The target.
    pixels : ndarray, shape (n, 2)
        Points found, row by row; a regular pattern.

    Returns
    -------
    Lattice
        The points found alone if nothing of the pattern is seen beyond their border.
    """
    lattice = lattice_of(target, pixels)
    look = _look(grey, target, lattice)
    sides, grown = list(SIDES), 0
    while sides and grown < _LONGEST_GROWTH:
        side = sides[0]
        line = lattice.beyond(side)
        shown, refined = look.shown(line)
        seen = np.isfinite(shown)
        matches = int(shown[seen].sum())
        if matches < max(_FEWEST_BEYOND, _MOST * _MOST * seen.sum()):
            sides.pop(0)
            continue
        grown += 1
        lattice = lattice.extended(line.moved(np.where((shown == 1.0)[:, np.newaxis], refined, line.pixels)))
    return lattice


def trimmed(grey: Image, grid: Floats) -> Floats:
    """Return a grid of chessboard corners, shape (rows, columns, 2), without the lines at its border that are none."""
    target = Target("chessboard", grid.shape[1], grid.shape[0], 1.0)
    lattice = lattice_of(target, grid.reshape(-1, 2))
    shown = (_look(grey, target, lattice).shown(lattice.spots)[0] == 1.0).reshape(grid.shape[:2])
    while min(grid.shape[:2]) > 2:
        for cut in (np.s_[1:], np.s_[:-1], np.s_[:, 1:], np.s_[:, :-1]):
            kept = np.zeros(shown.shape, dtype=bool)
            kept[cut] = True
            if shown[~kept].mean() <= _HALF:
                grid, shown = grid[cut], shown[cut]
                break
        else:
            break
    return grid


def _look(grey: Image, target: Target, lattice: Lattice) -> Look:
    return Crossings(grey, lattice) if target.kind == "chessboard" else Discs(grey, lattice)


def _line(lattice: Lattice, side: str) -> NDArray[np.bool_]:
    """Return which points lie on the line at a side; for a column of asymmetric circles also on its neighbour."""
    axis = 0 if side.endswith("column") else 1
    sign = -1 if side.startswith("first") else 1
    along = sign * lattice.places[:, axis]
    reach = lattice.stride if axis == 0 else 1
    return np.asarray(along > along.max() - reach)
