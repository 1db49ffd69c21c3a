"""Time the next frames of a series with fedic: python series_fedic.py REF DEF X0 Y0 X1 Y1 SIZE THREADS OUT [cubic].

The reference is prepared first, untimed; every frame reads the deformed image again, starts from zero and is stored in
a file of its own beside OUT, as those of a series are: to replace a file, one waits for the disk. An iteration is timed
apart, from the solution on: what several of them take beyond a single one. Outside of the iterations are files and what
a single iteration takes beyond its own time: the coefficients of the image, the start, the result.
"""

from __future__ import annotations

import itertools
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fedic_settings import settings
from measure import Arguments, arguments, report

if TYPE_CHECKING:
    import fedic

_REPETITIONS = 15
_AT_LEAST = 2.0
"""Seconds for which what is short is repeated, to find a quiet moment."""
_AT_MOST = 5.0
"""Nothing is repeated any more after this time, but once."""
_ITERATIONS = 6


class Series(NamedTuple):
    """Median seconds of a frame and of the measurement in it, and its result."""

    frame: float
    measurement: float
    result: fedic.Result


def main() -> None:
    """Print the times of a frame, from file to stored result, and of an iteration, and what is outside of these."""
    given = arguments()
    with tempfile.TemporaryDirectory(dir=given.out.parent) as folder:
        series = measured_series(given, Path(folder))
    if not series.result.converged:
        sys.exit(f"not converged after {series.result.iterations} iterations")
    single, several = (seconds_of_iterations(given, number, series.result) for number in (1, _ITERATIONS))
    iteration = (several - single) / (_ITERATIONS - 1)
    series.result.write(given.out.with_suffix(".npz"))
    report(
        frame=series.frame,
        iteration=iteration,
        outside=series.frame - series.measurement + single - iteration,
        iterations=series.result.iterations,
        points=series.result.num_points,
    )


def prepared(given: Arguments, **options: float) -> fedic.Correlator:
    """Prepare the reference."""
    import fedic

    mesh = fedic.rectangle_mesh(given.bounds, size=given.size)
    return fedic.Correlator(fedic.read_image(given.reference, mapped=True), mesh, **settings(given), **options)


def measured_series(given: Arguments, folder: Path) -> Series:
    """Time frames from zero, stored in this folder."""
    import fedic

    correlator = prepared(given)
    files = (folder / f"{number}.npz" for number in itertools.count())

    def frame() -> tuple[float, float]:
        start = time.perf_counter()
        deformed = fedic.read_image(given.deformed, mapped=True)
        read = time.perf_counter()
        result = correlator.correlate(deformed)
        correlated = time.perf_counter()
        result.write(next(files))
        return time.perf_counter() - start, correlated - read

    seconds, measurement = (statistics.median(column) for column in zip(*_repeated(frame), strict=True))
    return Series(seconds, measurement, correlator.correlate(fedic.read_image(given.deformed, mapped=True)))


def seconds_of_iterations(given: Arguments, number: int, solution: fedic.Result) -> float:
    """Time a measurement of so many iterations from its own solution on: the fastest."""
    import fedic

    # No correction is as small as this tolerance.
    correlator = prepared(given, max_iterations=number, tolerance=1e-12)
    deformed = fedic.read_image(given.deformed, mapped=True)

    def iterate() -> tuple[float]:
        start = time.perf_counter()
        correlator.correlate(deformed, initial=solution.displacement)
        return (time.perf_counter() - start,)

    return min(_repeated(iterate))[0]


def _repeated(measure: Callable[[], tuple[float, ...]]) -> list[tuple[float, ...]]:
    """Return what is measured a few times, after a first time that does not count."""
    measure()
    begin = time.perf_counter()
    found: list[tuple[float, ...]] = []
    passed = 0.0
    while not found or passed < (_AT_MOST if len(found) < _REPETITIONS else _AT_LEAST):
        found.append(measure())
        passed = time.perf_counter() - begin
    return found


if __name__ == "__main__":
    main()
