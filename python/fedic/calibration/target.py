"""Flat calibration targets, their specifications such as ``chessboard:11x7:8``, and their points."""

import re
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from fedic._internal.types import Floats
from fedic.errors import OptionError

__all__ = ["Target", "parse_target"]

Kind: TypeAlias = Literal["chessboard", "circles", "asymmetric-circles", "ring-dots", "charuco"]

_FORMS: dict[Kind, str] = {
    "chessboard": "chessboard:COLUMNSxROWS:SQUARE, such as chessboard:11x7:8 (inner corners, side of a square)",
    "circles": "circles:COLUMNSxROWS:PITCH, such as circles:9x7:10 (circles, distance of two neighbours)",
    "asymmetric-circles": "asymmetric-circles:COLUMNSxROWS:PITCH, such as asymmetric-circles:4x11:10 (circles of a "
    "row, rows, distance of two rows)",
    "ring-dots": "ring-dots:COLUMNSxROWS:PITCH:LEFTxBELOW:ALONGxUP, such as ring-dots:14x10:10:3x2:8x6 (dots, distance "
    "of two neighbours, dots to the left of the ring at the origin and below it, steps from it to the ring on X and to "
    "the ring on Y)",
    "charuco": "charuco:COLUMNSxROWS:SQUARE:MARKER:DICTIONARY, such as charuco:12x8:10:7:DICT_5X5_100 (squares, side "
    "of a square, side of a marker, name in OpenCV)",
}
_SMALLEST = 2
_TWO_PITCHES = "two pitches, along a row and along a column, are joined by x: 8x8.04"


@dataclass(frozen=True)
class Target:
    """A flat calibration target.

    Its frame is the world of the calibrated camera: X to the right along a row, Y upwards along a column, Z out of the
    target towards the camera, the origin at the point at the lower left (for ChArUco at the lower left corner of the
    board, for dots with rings at the ring of the origin), in the unit of `pitch`. A target that looks the same upside
    down may be read upside down.

    Attributes
    ----------
    kind : {"chessboard", "circles", "asymmetric-circles", "ring-dots", "charuco"}
        Printed pattern.
    columns, rows : int
        Inner corners of a chessboard, circles of a row and rows of circles, squares of a ChArUco board.
    pitch : float or (float, float)
        Side of a square, distance of neighbouring circles, or of neighbouring rows of asymmetric circles; its unit is
        that of the world. Two numbers are the pitches along X and Y of a target that is not square: its printer
        stretches one direction. A wrong unit scales the translations only: a single camera cannot detect it.
    marker : float
        Side of a ChArUco marker.
    dictionary : str
        OpenCV's name of the ChArUco markers, such as ``"DICT_5X5_100"``.
    origin : (int, int)
        Of dots with rings: columns to the left of the ring at the origin, and rows below it.
    axes : (int, int)
        Of dots with rings: steps from the ring at the origin to the ring on the X axis, and to that on the Y axis.
    """

    kind: Kind
    columns: int
    rows: int
    pitch: float | tuple[float, float]
    marker: float = 0.0
    dictionary: str = ""
    origin: tuple[int, int] = (0, 0)
    axes: tuple[int, int] = (0, 0)

    @property
    def pitches(self) -> tuple[float, float]:
        """Pitches along X and Y."""
        x, y = np.broadcast_to(np.asarray(self.pitch, dtype=np.float64), 2)
        return float(x), float(y)

    @property
    def points(self) -> Floats:
        """Positions of the points, shape (n, 3), row by row from the upper left; Z is zero."""
        columns, rows = (self.columns - 1, self.rows - 1) if self.kind == "charuco" else (self.columns, self.rows)
        row, column = (index.ravel().astype(np.float64) for index in np.indices((rows, columns)))
        if self.kind == "asymmetric-circles":
            column = 2.0 * column + row % 2.0
        elif self.kind == "charuco":
            column, row = column + 1.0, row - 1.0
        places = np.column_stack([column, rows - 1.0 - row, np.zeros_like(row)]) - [*self.origin, 0.0]
        return places * [*self.pitches, 0.0]

    def __str__(self) -> str:
        ends = f":{self.marker:g}:{self.dictionary}" if self.kind == "charuco" else ""
        if self.kind == "ring-dots":
            ends = "".join(f":{first}x{second}" for first, second in (self.origin, self.axes))
        pitches = "x".join(f"{pitch:g}" for pitch in dict.fromkeys(self.pitches))
        return f"{self.kind}:{self.columns}x{self.rows}:{pitches}{ends}"


def parse_target(text: str) -> Target:
    """Read the specification of a target.

    Parameters
    ----------
    text : str
        ``"chessboard:11x7:8"``, ``"circles:9x7:10"``, ``"asymmetric-circles:4x11:10"``,
        ``"ring-dots:14x10:10:3x2:8x6"`` or ``"charuco:12x8:10:7:DICT_5X5_100"``; counts as in OpenCV, see `Target`. Two
        pitches are joined by ``x``: ``"chessboard:11x7:8x8.04"``.

    Returns
    -------
    Target
        The target.

    Raises
    ------
    OptionError
        If the specification has another form, or impossible sizes.
    """
    kind, *fields = text.strip().split(":")
    if kind not in _FORMS:
        raise OptionError(
            f"target {text!r}: {kind!r} is unknown; give one of\n  " + "\n  ".join(_FORMS.values()), "target"
        )
    expected = 4 if kind in ("charuco", "ring-dots") else 2
    counts = _counts(fields[0]) if len(fields) == expected else None
    pitches = _lengths(fields[1]) if counts else []
    further = _lengths(fields[2]) if kind == "charuco" and counts else []
    rings = [_counts(field) for field in fields[2:]] if kind == "ring-dots" else []
    if counts is None or not pitches or (kind == "charuco" and len(further) != 1) or None in rings:
        raise OptionError(f"target {text!r}: should be written {_FORMS[kind]}; {_TWO_PITCHES}.", "target")
    columns, rows = counts
    if min(columns, rows) < _SMALLEST + (kind == "charuco"):
        raise OptionError(f"target {text!r}: {columns} x {rows} is too small; count as in {_FORMS[kind]}.", "target")
    if not all(0.0 < length < np.inf for length in (*pitches, *further)):
        raise OptionError(f"target {text!r}: the lengths must be positive; write {_FORMS[kind]}.", "target")
    pitch = pitches[0] if len(pitches) == 1 else (pitches[0], pitches[1])
    if kind == "charuco":
        if further[0] >= min(pitches):
            raise OptionError(
                f"target {text!r}: a marker ({further[0]:g}) must be smaller than its square ({min(pitches):g}).",
                "target",
            )
        return Target(kind, columns, rows, pitch, further[0], _known_dictionary(text, fields[3]))
    if kind == "ring-dots":
        origin, axes = (each for each in rings if each is not None)
        if min(axes) < 1 or origin[0] + axes[0] >= columns or origin[1] + axes[1] >= rows:
            raise OptionError(f"target {text!r}: the rings must be dots of the target; write {_FORMS[kind]}.", "target")
        return Target(kind, columns, rows, pitch, origin=origin, axes=axes)
    return Target(kind, columns, rows, pitch)


def _counts(text: str) -> tuple[int, int] | None:
    """Return two counts joined by x; None for another text."""
    found = re.fullmatch(r"(\d+)[xX](\d+)", text)
    return (int(found[1]), int(found[2])) if found else None


def _lengths(text: str) -> list[float]:
    """Return one length or two joined by x; none for another text."""
    try:
        found = [float(length) for length in re.split("[xX]", text)]
    except ValueError:
        return []
    return found if len(found) <= 2 else []


def _known_dictionary(text: str, name: str) -> str:
    import cv2

    known = [each for each in dir(cv2.aruco) if each.startswith("DICT_")]
    if name not in known:
        raise OptionError(
            f"target {text!r}: {name!r} is not a dictionary of markers; OpenCV has {', '.join(known)}.", "target"
        )
    return name
