"""Metrological efficiency indicator (MEI) of the DIC Challenge 2.0: noise times the shortest period resolved."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.experiments.dic_challenge_star import AMPLITUDE, Star, period_at
from fedic.experiments.outcome import Row
from fedic.results import Result

__all__ = ["Field", "Measured", "Merit", "field_of", "measure_merit"]

Field: TypeAlias = Callable[[Floats, Floats], Floats]
"""A displacement field on a grid of columns (m) and rows (n): shape (n, m, 2), NaN where it is not known."""

_RESOLVED = 0.9
_AVERAGED = 40
"""Columns over which the amplitude is averaged."""
_FIRST_COLUMN, _LAST_MARGIN = 10.0, 20.0
_KEPT_ELEMENTS = 1.5
"""Number of elements at the upper and lower edge of the mesh that are left out of the noise."""


@dataclass(frozen=True, eq=False)
class Merit:
    """Noise and resolution of a measured field.

    Attributes
    ----------
    noise : float
        Standard deviation of the horizontal displacement in the region of long periods, in pixels.
    period : float
        Shortest period at which the measured amplitude reaches nine tenths of the true one, in pixels.
    kept_period : float
        Period, in pixels, above which the amplitude stays above nine tenths; longer than `period` if the amplitude does
        not increase monotonically.
    accurate_period : float
        Period, in pixels, above which the amplitude stays within a tenth of the true one.
    periods, amplitudes : ndarray, shape (m,)
        Amplitude, relative to the true one, over the period.
    """

    noise: float
    period: float
    kept_period: float
    accurate_period: float
    periods: Floats
    amplitudes: Floats

    @property
    def mei(self) -> float:
        """Metrological efficiency indicator, in square pixels: lower is better."""
        return self.noise * self.period

    @property
    def kept_mei(self) -> float:
        """MEI with `kept_period` instead of `period`."""
        return self.noise * self.kept_period

    def as_row(self) -> dict[str, Any]:
        """Return the entries of a table's row."""
        return {
            "noise_px": self.noise,
            "period_px": self.period,
            "kept_period_px": self.kept_period,
            "accurate_period_px": self.accurate_period,
            "peak_amplitude": float(self.amplitudes.max()),
            "mei": self.mei,
        }


@dataclass(frozen=True, eq=False)
class Measured:
    """Noise and resolution of one variant of the measurement.

    Attributes
    ----------
    star : str
        Pair of images.
    group : str
        Group of comparable variants: ``sizes``, ``settings``, ``averages``, ``nodes`` or ``turned``.
    variant : str
        Variant.
    cell : str
        Cell type.
    size : int
        Edge of the elements, in pixels.
    merit : Merit
        Noise and resolution.
    iterations : int
        Largest number of iterations of its measurements.
    converged : bool
        True if all its measurements converged.
    """

    star: str
    group: str
    variant: str
    cell: str
    size: int
    merit: Merit
    iterations: int
    converged: bool

    def as_row(self) -> Row:
        """Return a row of the table."""
        return {
            "star": self.star,
            "group": self.group,
            "variant": self.variant,
            "cell": self.cell,
            "size_px": self.size,
            **self.merit.as_row(),
            "iterations": self.iterations,
            "converged": self.converged,
        }


def field_of(result: Result) -> Field:
    """Return the field of a measurement in the image frame."""

    def field(columns: Floats, rows: Floats) -> Floats:
        grid = np.stack(np.meshgrid(columns, rows), axis=-1)
        return result.mesh.interpolate(result.unchecked_displacement, grid.reshape(-1, 2)).reshape(grid.shape)

    return field


def measure_merit(field: Field, star: Star, size: float, reach: float) -> Merit:
    """Evaluate noise and resolution of a field by the protocol of the challenge.

    Parameters
    ----------
    field : callable
        The field, evaluated at every pixel.
    star : Star
        The star.
    size : float
        Edge of the elements, in pixels.
    reach : float
        Extent of the field above and below the crest, in pixels.

    Returns
    -------
    Merit
        Its noise and resolution.
    """
    inner = reach - _KEPT_ELEMENTS * size
    rows = np.arange(np.ceil(star.middle - inner), star.middle + inner)
    noise = float(field(star.calm_columns, rows)[..., 0].std())
    columns = np.arange(_FIRST_COLUMN, star.width - _LAST_MARGIN)
    crest = field(columns, np.array([star.middle]))[0, :, 1] / AMPLITUDE
    amplitudes = np.convolve(crest, np.full(_AVERAGED, 1.0 / _AVERAGED), mode="valid")
    known = np.isfinite(amplitudes)
    periods = period_at(columns[: len(amplitudes)] + (_AVERAGED - 1) / 2)[known]
    amplitudes = amplitudes[known]
    above = amplitudes >= _RESOLVED
    return Merit(
        noise=noise,
        period=_crossing(periods, amplitudes, int(np.argmax(above)) if above.any() else len(above)),
        kept_period=_crossing(periods, amplitudes, _settled(above)),
        accurate_period=_period_from(periods, _settled(np.abs(amplitudes - 1.0) <= 1.0 - _RESOLVED)),
        periods=periods,
        amplitudes=amplitudes,
    )


def _settled(fulfilled: NDArray[np.bool_]) -> int:
    """Return the first index after which a condition is always fulfilled."""
    return 0 if fulfilled.all() else len(fulfilled) - int(np.argmin(fulfilled[::-1]))


def _period_from(periods: Floats, index: int) -> float:
    return float(periods[index]) if index < len(periods) else float("nan")


def _crossing(periods: Floats, amplitudes: Floats, index: int) -> float:
    """Return the period at which the amplitude crosses nine tenths just before an index; NaN past the end."""
    if index >= len(periods):
        return float("nan")
    if index == 0:
        return float(periods[0])
    step = slice(index - 1, index + 1)
    return float(np.interp(_RESOLVED, amplitudes[step], periods[step]))
