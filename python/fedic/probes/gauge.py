"""Gauges: regions whose mean is read, and extensometers."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from fedic._internal.types import Floats
from fedic.errors import OptionError
from fedic.probes.polygons import crossing_sides, polygon_area, polygon_pieces

__all__ = ["Gauge"]

_ALONG_LINE = (32, 2000)
"""Smallest and largest number of points along a line."""


@dataclass(frozen=True, eq=False)
class Gauge:
    """A place of the mesh where displacement and strain are read, in the reference configuration.

    Made by `polygon`, `rectangle`, `line` or `extensometer`; read by the tables of a series.

    Attributes
    ----------
    kind : {"area", "line", "extensometer"}
        Whether the mean over an area or along a line is read, or the motion of two points.
    points : ndarray of float, shape (n, 2)
        Corners of the area, ends of the line, or points of the extensometer, in the mesh's unit.
    name : str
        Name in the columns of tables; empty for its number.
    """

    kind: Literal["area", "line", "extensometer"]
    points: Floats
    name: str = ""

    def __str__(self) -> str:
        return f"gauge {self.name!r}" if self.name else f"gauge ({self.kind})"

    @classmethod
    def polygon(cls, points: ArrayLike, *, name: str = "") -> "Gauge":
        """Make a gauge that reads the mean over a polygon.

        The polygon is cut by a grid; the mean is that at the centres of the pieces, weighted by their areas. The mean
        of a linear field is exact. The rectangles of the grid are at most a quarter of a cell wide, unless that takes
        more than 4,000.

        Parameters
        ----------
        points : array_like, shape (n, 2)
            Corners in order, in the mesh's unit.
        name : str, optional
            Name in the columns of tables.

        Returns
        -------
        Gauge
            The gauge.

        Raises
        ------
        OptionError
            If there are fewer than three corners, sides cross, or the area is zero.
        """
        corners = _checked(points, "points", name)
        if len(corners) < 3:
            raise OptionError(f"points of {_described(name)} has {len(corners)} corners; give three or more.", "points")
        crossing = crossing_sides(corners)
        if crossing is not None:
            raise OptionError(
                f"points of {_described(name)}: the sides that begin at corners {crossing[0]} and {crossing[1]} cross; "
                "give the corners in their order along the outline.",
                "points",
            )
        if polygon_area(corners) <= 1e-12 * float(np.ptp(corners, axis=0).max()) ** 2:
            raise OptionError(f"points of {_described(name)} enclose no area.", "points")
        return cls("area", corners, name)

    @classmethod
    def rectangle(cls, x0: float, y0: float, x1: float, y1: float, *, name: str = "") -> "Gauge":
        """Make a gauge that reads the mean over a rectangle, as `polygon`.

        Parameters
        ----------
        x0, y0, x1, y1 : float
            Two opposite corners, in the mesh's unit.
        name : str, optional
            Name in the columns of tables.

        Returns
        -------
        Gauge
            The gauge.

        Raises
        ------
        OptionError
            If the area is zero.
        """
        return cls.polygon([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], name=name)

    @classmethod
    def line(cls, start: ArrayLike, end: ArrayLike, *, name: str = "") -> "Gauge":
        """Make a gauge that reads the mean along a straight line.

        The mean is that at the middles of equal parts of the line, eight or more in a cell, 32 to 2000 in all.

        Parameters
        ----------
        start, end : array_like, shape (2,)
            Ends of the line, in the mesh's unit.
        name : str, optional
            Name in the columns of tables.

        Returns
        -------
        Gauge
            The gauge.

        Raises
        ------
        OptionError
            If the ends coincide.
        """
        return cls("line", _ends(start, end, ("start", "end"), name), name)

    @classmethod
    def extensometer(cls, a: ArrayLike, b: ArrayLike, *, name: str = "") -> "Gauge":
        """Make a virtual extensometer between two points.

        It reads ``elongation``, the change of the distance in the mesh's unit; ``strain``, the elongation by the
        distance in the reference configuration; and ``rotation``, the angle of the line in radians, counter-clockwise.

        Parameters
        ----------
        a, b : array_like, shape (2,)
            The points, in the mesh's unit.
        name : str, optional
            Name in the columns of tables.

        Returns
        -------
        Gauge
            The gauge.

        Raises
        ------
        OptionError
            If the points coincide.
        """
        return cls("extensometer", _ends(a, b, ("a", "b"), name), name)

    def samples(self, cell_size: float) -> tuple[Floats, Floats]:
        """Return the points where the gauge is read.

        Parameters
        ----------
        cell_size : float
            Typical size of the cells, in the mesh's unit.

        Returns
        -------
        points : ndarray, shape (m, 2)
            The points; of an extensometer its two points.
        weights : ndarray, shape (m,)
            Their weights in the mean, with the sum 1.
        """
        if self.kind == "area":
            points, weights = polygon_pieces(self.points, 0.25 * cell_size)
            return points, weights / weights.sum()
        if self.kind == "line":
            length = float(np.hypot(*(self.points[1] - self.points[0])))
            count = int(np.clip(np.ceil(min(8.0 * length / cell_size, _ALONG_LINE[1])), *_ALONG_LINE))
            places = (np.arange(count) + 0.5) / count
            return self.points[0] + places[:, np.newaxis] * (self.points[1] - self.points[0]), np.full(count, 1 / count)
        return self.points, np.full(2, 0.5)


def _described(name: object) -> str:
    return f"gauge {name!r}" if name else "a gauge"


def _checked(points: ArrayLike, argument: str, name: object) -> Floats:
    if not isinstance(name, str):
        raise OptionError(f"name={name!r}: the name of a gauge is a text.", "name")
    try:
        found = np.array(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise OptionError(f"{argument} of {_described(name)} must be numbers, got {points!r}.", argument) from error
    if found.ndim != 2 or found.shape[1] != 2:
        raise OptionError(
            f"{argument} of {_described(name)} has shape {found.shape}; give points (x, y), shape (n, 2).", argument
        )
    if not np.isfinite(found).all():
        raise OptionError(f"{argument} of {_described(name)} has a coordinate that is not finite.", argument)
    return found


def _ends(start: ArrayLike, end: ArrayLike, arguments: tuple[str, str], name: str) -> Floats:
    both = zip((start, end), arguments, strict=True)
    ends = np.vstack([_checked(np.atleast_2d(np.asarray(each)), argument, name) for each, argument in both])
    if len(ends) != 2:
        raise OptionError(f"{' and '.join(arguments)} of {_described(name)}: give one point (x, y) each.", arguments[0])
    if (ends[0] == ends[1]).all():
        raise OptionError(f"{' and '.join(arguments)} of {_described(name)} coincide.", arguments[0])
    return ends
