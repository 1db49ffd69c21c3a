"""Numbers and units in the text files of programs."""

import re
from pathlib import Path

from fedic.errors import CameraError

__all__ = ["ANGLES", "LENGTHS", "PIXELS", "Decimals", "check_unit", "split_unit"]

PIXELS = ("", "px", "pixel", "pixels", "pix")
ANGLES = ("", "deg", "degree", "degrees", "°")
LENGTHS = ("", "mm", "millimeter", "millimetre", "millimeters", "millimetres")

_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")


def split_unit(key: str) -> tuple[str, str]:
    """Return a key such as ``"Tx [mm]"`` without its unit, and the unit; empty if there is none."""
    match = re.fullmatch(r"(.*?)\s*\[([^\]]*)\]\s*", key)
    return (key.strip(), "") if match is None else (match[1].strip(), match[2].strip())


def check_unit(path: Path, key: str, unit: str, known: tuple[str, ...]) -> None:
    """Check the unit of a value.

    Parameters
    ----------
    path : Path
        The file, for messages.
    key : str
        Key of the value.
    unit : str
        Its unit.
    known : tuple of str
        The units that are read.

    Raises
    ------
    CameraError
        If the unit is another one.
    """
    if unit.lower() not in known:
        raise CameraError(
            f"{path}: {key} is in [{unit}]; fedic reads it in {known[1]}: convert this number and the unit."
        )


class Decimals:
    """Reads numbers with a decimal point, or all with a decimal comma.

    Parameters
    ----------
    path : Path
        The file, for messages.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._with: dict[str, str] = {}

    def number(self, key: str, text: str) -> float:
        """Return the number of a text.

        Parameters
        ----------
        key : str
            Key of the value, for messages.
        text : str
            The text.

        Returns
        -------
        float
            The number.

        Raises
        ------
        CameraError
            If it is none, or has a comma where another number of the file has a point.
        """
        comma = _COMMA.fullmatch(text) is not None
        if comma or "." in text:
            self._with["comma" if comma else "point"] = f"{key} = {text}"
        if len(self._with) > 1:
            raise CameraError(
                f"{self._path}: {self._with['comma']} has a comma and {self._with['point']} a point; which one "
                "separates the decimals?"
            )
        try:
            return float(text.replace(",", ".") if comma else text)
        except ValueError:
            raise CameraError(f"{self._path}: {key} = {text!r} is not a number; is the file truncated?") from None
