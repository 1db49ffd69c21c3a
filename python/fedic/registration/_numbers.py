"""Checks of numbers given by the caller."""

import math
from numbers import Real

from fedic.errors import OptionError

__all__ = ["finite_number"]


def finite_number(name: str, value: object, wanted: str) -> float:
    """Check a number.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : object
        Value given by the caller.
    wanted : str
        Description of a valid value, for the message.

    Raises
    ------
    OptionError
        If the value is not a number, or not finite.
    """
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise OptionError(f"{name}={value!r}: give {wanted}.", name)
    return float(value)
