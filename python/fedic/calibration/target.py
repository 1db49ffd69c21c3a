"""Flat calibration targets, their specifications such as ``chessboard:11x7:8``, and their points."""

import re
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from fedic._internal.types import Floats
from fedic.errors import OptionError

__all__ = ["Target", "parse_target"]

Kind: TypeAlias = Literal["chessboard", "circles", "asymmetric-circles", "charuco"]

_FORMS: dict[Kind, str] = {
    "chessboard": "chessboard:COLUMNSxROWS:SQUARE, such as chessboard:11x7:8 (inner corners, side of a square)",
    "circles": "circles:COLUMNSxROWS:PITCH, such as circles:9x7:10 (circles, distance of two neighbours)",
    "asymmetric-circles": "asymmetric-circles:COLUMNSxROWS:PITCH, such as asymmetric-circles:4x11:10 (circles of a "
    "row, rows, distance of two rows)",
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
    board), in the unit of `pitch`. A target that looks the same upside down may be read upside down.

    Attributes
    ----------
    kind : {"chessboard", "circles", "asymmetric-circles", "charuco"}
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
    """

    kind: Kind
    columns: int
    rows: int
    pitch: float | tuple[float, float]
    marker: float = 0.0
    dictionary: str = ""

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
        return np.column_stack([column, rows - 1.0 - row, np.zeros_like(row)]) * [*self.pitches, 0.0]

    def __str__(self) -> str:
        ends = f":{self.marker:g}:{self.dictionary}" if self.kind == "charuco" else ""
        pitches = "x".join(f"{pitch:g}" for pitch in dict.fromkeys(self.pitches))
        return f"{self.kind}:{self.columns}x{self.rows}:{pitches}{ends}"


def parse_target(text: str) -> Target:
    """Read the specification of a target.

    Parameters
    ----------
    text : str
        ``"chessboard:11x7:8"``, ``"circles:9x7:10"``, ``"asymmetric-circles:4x11:10"`` or
        ``"charuco:12x8:10:7:DICT_5X5_100"``; counts as in OpenCV, see `Target`. Two pitches are joined by ``x``:
        ``"chessboard:11x7:8x8.04"``.

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
    expected = 4 if kind == "charuco" else 2
    counts = re.fullmatch(r"(\d+)[xX](\d+)", fields[0]) if len(fields) == expected else None
    pitches, lengths = list[float](), list[float]()
    try:
        pitches = [float(length) for length in re.split("[xX]", fields[1])] if counts else []
        lengths = [*pitches, *(float(length) for length in fields[2:3])]
    except ValueError:
        counts = None
    if len(pitches) > 2:
        counts = None
    if counts is None:
        raise OptionError(f"target {text!r}: should be written {_FORMS[kind]}; {_TWO_PITCHES}.", "target")
    columns, rows = (int(count) for count in counts.groups())
    if min(columns, rows) < _SMALLEST + (kind == "charuco"):
        raise OptionError(f"target {text!r}: {columns} x {rows} is too small; count as in {_FORMS[kind]}.", "target")
    if not all(0.0 < length < np.inf for length in lengths):
        raise OptionError(f"target {text!r}: the lengths must be positive; write {_FORMS[kind]}.", "target")
    pitch = pitches[0] if len(pitches) == 1 else (pitches[0], pitches[1])
    if kind != "charuco":
        return Target(kind, columns, rows, pitch)
    marker = lengths[-1]
    if marker >= min(pitches):
        raise OptionError(
            f"target {text!r}: a marker ({marker:g}) must be smaller than its square ({min(pitches):g}).", "target"
        )
    return Target(kind, columns, rows, pitch, marker, _known_dictionary(text, fields[3]))


def _known_dictionary(text: str, name: str) -> str:
    import cv2

    known = [each for each in dir(cv2.aruco) if each.startswith("DICT_")]
    if name not in known:
        raise OptionError(
            f"target {text!r}: {name!r} is not a dictionary of markers; OpenCV has {', '.join(known)}.", "target"
        )
    return name
