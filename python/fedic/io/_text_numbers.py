"""Numbers written as text."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["numbers_of"]


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
        what = "a number" if kind is np.float64 else "an integer"
        raise ValueError(f"{text[:40]!r} stands where {what} is expected") from error


def _is_number(word: str | bytes, kind: type[np.float64] | type[np.int64]) -> bool:
    try:
        kind(float(word) if kind is np.float64 else int(word))
    except (ValueError, OverflowError):
        return False
    return True
