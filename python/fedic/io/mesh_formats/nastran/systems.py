"""Coordinate systems of Nastran: ``CORD1R``, ``CORD2C`` and the like."""

from collections.abc import Callable

import numpy as np

from fedic.io.mesh_formats._coordinates import Array, System, axes, from_cylindrical, from_spherical
from fedic.io.mesh_formats.nastran.cards import Card

__all__ = ["Systems"]


MAX_NESTED = 100
"""Largest number of systems that depend on each other in a chain."""


class Systems:
    """The coordinate systems of a file.

    Parameters
    ----------
    node : callable
        Returns the coordinates, shape (3,), of a node in the basic system.
    """

    def __init__(self, node: Callable[[int, Card], Array]) -> None:
        self._node = node
        self._cards: dict[int, tuple[Card, int]] = {}
        self._known: dict[int, System] = {}
        self._open: list[int] = []

    def add(self, card: Card) -> None:
        """Take over the systems of a card.

        Parameters
        ----------
        card : Card
            ``CORD1R``, ``CORD1C``, ``CORD1S`` (one or two systems), ``CORD2R``, ``CORD2C`` or ``CORD2S``.

        Raises
        ------
        MeshError
            If a system is defined a second time, in another way.
        """
        starts = [1, 5] if card.name.startswith("CORD1") and card.text(5) else [1]
        for start in starts:
            number = card.label(start)
            if number in self._cards and self._cards[number][0].fields != card.fields:
                raise card.error(f"the coordinate system {number} is defined a second time.")
            self._cards[number] = (card, start)

    def basic(self, number: int, points: Array, card: Card) -> Array:
        """Return points in the basic system.

        Parameters
        ----------
        number : int
            The system in which they are given; 0 is the basic system.
        points : ndarray, shape (n, 3)
            Coordinates in that system.
        card : Card
            The card that refers to it.

        Returns
        -------
        ndarray, shape (n, 3)
            Coordinates in the basic system.

        Raises
        ------
        MeshError
            If the system is not in the file, or depends on itself.
        """
        if number == 0:
            return points
        if number not in self._cards:
            raise card.error(
                f"the coordinate system {number} is not defined by CORD1R, CORD2R or the like in the file."
            )
        kind = self._cards[number][0].name[-1]
        if kind != "R":
            points = from_cylindrical(points) if kind == "C" else from_spherical(points)
        origin, rows = self._frame(number)
        return np.asarray(points @ rows + origin)

    def _frame(self, number: int) -> System:
        if number not in self._known:
            card, start = self._cards[number]
            if number in self._open:
                raise card.error(f"the coordinate system {number} depends on itself.")
            if len(self._open) >= MAX_NESTED:
                raise card.error(f"more than {MAX_NESTED} coordinate systems depend on each other in a chain.")
            self._open.append(number)
            if card.name.startswith("CORD1"):
                corners = np.array([self._node(card.label(start + place), card) for place in (1, 2, 3)])
            else:
                given = np.array([card.real(place) for place in range(3, 12)]).reshape(3, 3)
                corners = self.basic(card.integer(2, 0), given, card)
            self._open.remove(number)
            origin, on_z, in_xz = corners
            try:
                z, x, y = axes(on_z - origin, in_xz - origin)
            except ValueError as error:
                raise card.error(f"not a valid {card.name} card ({error}).") from error
            self._known[number] = (origin, np.stack([x, y, z]))
        return self._known[number]
