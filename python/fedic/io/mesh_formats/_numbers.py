"""Numbers written as text."""

import math
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["checked_label", "integer", "label", "numbers_of", "real", "shown"]

_REAL = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdD]([+-]?\d+)|([+-]\d+))?", re.ASCII)
_INTEGER = re.compile(r"[+-]?\d+", re.ASCII)
_LARGEST = 2**63 - 1
_SHOWN = 12


def real(text: str) -> float:
    """Return a number; an exponent may follow ``E``, ``D`` or, as in Fortran, its sign alone: ``1.5-3``.

    Parameters
    ----------
    text : str
        The number, without blanks.

    Returns
    -------
    float
        Its value.

    Raises
    ------
    ValueError
        If the text is no number or the number is not finite.
    """
    match = _REAL.fullmatch(text)
    if match is None:
        raise ValueError(f"{shown(text)} is not a number")
    mantissa, exponent, bare = match.groups()
    value = float(f"{mantissa}e{exponent or bare or 0}")
    if not math.isfinite(value):
        raise ValueError(f"{shown(text)} is too large a number")
    return value


def integer(text: str) -> int:
    """Return a whole number of at most 63 bits.

    Parameters
    ----------
    text : str
        The number, without blanks.

    Returns
    -------
    int
        Its value.

    Raises
    ------
    ValueError
        If the text is no whole number or the number is too large.
    """
    if len(text) < 19 and text.isdigit() and text.isascii():
        return int(text)
    if _INTEGER.fullmatch(text) is None:
        raise ValueError(f"{shown(text)} is not a whole number")
    value = int(text) if len(text) <= 20 else _LARGEST + 1
    if abs(value) > _LARGEST:
        raise ValueError(f"{shown(text)} is too large a number")
    return value


def label(text: str) -> int:
    """Return the number of a node or an element, which is positive.

    Parameters
    ----------
    text : str
        The number, without blanks.

    Returns
    -------
    int
        Its value.

    Raises
    ------
    ValueError
        If the text is no positive whole number or the number is too large.
    """
    return checked_label(integer(text))


def checked_label(value: int) -> int:
    """Return the number of a node or an element, which has been computed.

    Parameters
    ----------
    value : int
        The number.

    Returns
    -------
    int
        The same number.

    Raises
    ------
    ValueError
        If the number is not positive or too large.
    """
    if value <= 0:
        raise ValueError(f"{shown(str(value))} is not the number of a node or an element, which is positive")
    if value > _LARGEST:
        raise ValueError(f"{shown(str(value))} is too large a number")
    return value


def shown(text: str) -> str:
    """Return text of a file as a message quotes it: only its beginning, for the file may not be meant to be read.

    Parameters
    ----------
    text : str
        The text.

    Returns
    -------
    str
        At most 12 characters in quotation marks.
    """
    return repr(text if len(text) <= _SHOWN else f"{text[:_SHOWN]}...")


def numbers_of(words: Sequence[str] | Sequence[bytes], kind: type[np.float64] | type[np.int64]) -> NDArray[Any]:
    """Return the numbers that words spell.

    Parameters
    ----------
    words : sequence of str or bytes
        The words.
    kind : type
        ``np.float64`` or ``np.int64``.

    Returns
    -------
    ndarray, shape (n,)
        The numbers.

    Raises
    ------
    ValueError
        If a word is no number of that kind; the message names it.
    """
    spell = float if kind is np.float64 else int
    try:
        return np.fromiter(map(spell, words), kind, len(words))
    except (ValueError, OverflowError) as error:
        wrong = next((word for word in words if not _is_number(word, kind)), words[0])
        text = wrong.decode("utf-8", "replace") if isinstance(wrong, bytes) else wrong
        what = "a number" if kind is np.float64 else "a whole number"
        raise ValueError(f"{shown(text)} is not {what}") from error


def _is_number(word: str | bytes, kind: type[np.float64] | type[np.int64]) -> bool:
    try:
        kind(float(word) if kind is np.float64 else int(word))
    except (ValueError, OverflowError):
        return False
    return True
