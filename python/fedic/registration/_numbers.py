"""Numbers as a caller gives them."""

import math
from numbers import Real

from fedic.errors import CameraError

__all__ = ["finite_number"]


def finite_number(name: str, value: object, wanted: str) -> float:
    """Check a number.

    Parameters
    ----------
    name : str
        Of the argument.
    value : object
        What the caller gave.
    wanted : str
        What to give instead, for the message.

    Raises
    ------
    CameraError
        If it is no number, or not finite.
    """
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise CameraError(f"{name}={value!r}: give {wanted}.")
    return float(value)
