"""Rules on what data determine: one set of limits for calibration and registration."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from fedic._internal.types import Floats

__all__ = [
    "LARGEST_CONDITION",
    "LARGEST_RELATIVE_DEVIATION",
    "correlated_pairs",
    "insignificant",
    "join_names",
    "undetermined",
]

_SMALLEST_RATIO = 1e-6
"""Singular value of the Jacobian, columns scaled to unit length, relative to the largest: the data do not determine a
direction below it."""
_UNSEEN = 1e-12
"""Length of a column of the Jacobian, relative to the longest: the data do not depend on its parameter below it."""
_NAMED = 0.1
"""Component of such a direction from which its parameter is named."""
LARGEST_CONDITION = _SMALLEST_RATIO**-2
"""Condition number of a normal matrix with a scaled diagonal up to which the data determine the parameters."""
LARGEST_RELATIVE_DEVIATION = 0.1
"""Standard deviation of a focal length, scale or distance, relative to its value, that is no result any more."""
_LARGEST_CORRELATION = 0.998
_SIGNIFICANT = 2.0


def undetermined(names: Sequence[str], jacobian: Floats) -> list[str]:
    """Return the parameters that take part in changes the data do not show.

    Parameters
    ----------
    names : sequence of str
        The parameters.
    jacobian : ndarray, shape (m, p)
        Derivatives of the data, finite.

    Returns
    -------
    list of str
        Empty if the data determine all parameters.
    """
    lengths = np.linalg.norm(jacobian, axis=0)
    unseen = [name for name, length in zip(names, lengths, strict=True) if length <= _UNSEEN * lengths.max()]
    if unseen:
        return unseen
    _, values, directions = np.linalg.svd(jacobian / lengths, full_matrices=True)
    values = np.append(values, np.zeros(len(names) - len(values)))
    hidden = np.abs(directions[values <= _SMALLEST_RATIO * values[0]])
    return [name for name, parts in zip(names, hidden.T, strict=True) if len(parts) and parts.max() > _NAMED]


def correlated_pairs(
    names: Sequence[str], covariance: Floats, *, at_least: float = _LARGEST_CORRELATION
) -> Iterator[tuple[str, str, float]]:
    """Yield the pairs of parameters that can hardly be told apart, the strongest correlation first.

    Parameters
    ----------
    names : sequence of str
        The parameters.
    covariance : ndarray, shape (p, p)
        Their covariance.
    at_least : float
        Smallest absolute value of a correlation that is yielded.

    Yields
    ------
    (str, str, float)
        Two parameters and their correlation.
    """
    deviations = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(deviations, deviations)
    strong = [pair for pair in combinations(range(len(names)), 2) if abs(correlation[pair]) >= at_least]
    for row, column in sorted(strong, key=lambda pair: -abs(correlation[pair])):
        yield names[row], names[column], float(correlation[row, column])


def insignificant(values: Mapping[str, float], deviations: Mapping[str, float]) -> list[str]:
    """Return the parameters that differ from zero by less than two standard deviations."""
    return [name for name, value in values.items() if abs(value) < _SIGNIFICANT * deviations[name]]


def join_names(names: Sequence[str]) -> str:
    """Return names as in a sentence: ``a, b and c``."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
