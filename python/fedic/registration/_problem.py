"""Unknowns, data and rows of the least-squares problem of a registration."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats, Image
from fedic.registration._edges import Edge, Strip
from fedic.registration._pairs import Pairs, Place, pair_rows
from fedic.registration._pose import Placeable, move

__all__ = ["Estimate", "Group", "Problem", "for_all_unknowns", "pair_groups", "unknowns_of"]


@dataclass(frozen=True, eq=False)
class Estimate:
    """Values of the unknowns: a camera and, if it is unknown, the placement of a target."""

    camera: Placeable
    place: Place | None = None

    def moved(self, names: tuple[str, ...], step: Floats) -> "Estimate":
        """Return the estimate moved by a step: the parameters `names`, then those of the placement."""
        place = None if self.place is None else self.place.moved(step[len(names) :])
        return Estimate(move(self.camera, names, step[: len(names)]), place)


@dataclass(frozen=True, eq=False)
class Problem:
    """Data of a registration.

    Attributes
    ----------
    image : ndarray, shape (height, width)
        The image.
    names : tuple of str
        The free parameters.
    strips : sequence of Strip
        Features whose edges are fitted.
    pairs : sequence of Pairs
        Point pairs that are fitted.
    """

    image: Image
    names: tuple[str, ...]
    strips: Sequence[Strip] = ()
    pairs: Sequence[Pairs] = ()


@dataclass(frozen=True, eq=False)
class Group:
    """Rows of equal noise: the edge segments of a feature, or the coordinates of points.

    Attributes
    ----------
    residuals : ndarray, shape (n,)
        Measured minus projected, in pixels.
    jacobian : ndarray, shape (n, p)
        Derivatives of the projection with respect to the unknowns.
    used : ndarray of bool, shape (n,)
        False for rows left out of the fit.
    noise : float
        Standard deviation of a residual, in pixels.
    edge : Edge, optional
        The edge, for the rows of a feature.
    known : bool
        True if the noise is known; otherwise it is estimated from the residuals.
    """

    residuals: Floats
    jacobian: Floats
    used: NDArray[np.bool_]
    noise: float
    edge: Edge | None = None
    known: bool = False


def unknowns_of(estimate: Estimate, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of all unknowns."""
    return names if estimate.place is None else (*names, "target x", "target y", "target angle")


def pair_groups(estimate: Estimate, problem: Problem) -> list[Group]:
    """Return the rows of the points."""
    groups = []
    for pairs in problem.pairs:
        residuals, jacobian = pair_rows(estimate.camera, estimate.place, pairs, problem.names)
        used = np.ones(len(residuals), dtype=bool)
        groups.append(Group(residuals, jacobian, used, pairs.noise, known=pairs.known))
    return groups


def for_all_unknowns(estimate: Estimate, jacobian: Floats) -> Floats:
    """Append the derivatives with respect to the placement of a target, which are zero, to those of the parameters."""
    return jacobian if estimate.place is None else np.column_stack([jacobian, np.zeros((len(jacobian), 3))])
