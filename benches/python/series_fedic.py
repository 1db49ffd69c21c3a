"""Time the next frames of a series with fedic: python series_fedic.py REF DEF X0 Y0 X1 Y1 SIZE THREADS OUT [cubic].

The reference is prepared first, untimed; every frame reads the deformed image again and starts from zero. A frame is
measured once more from its own solution, in one iteration: what the full measurement took beyond it is the time of the
iterations beyond the first. The callback ``progress`` tells no such time: it comes in batches every 50 ms.
"""

import statistics
import sys
import time

from fedic_settings import settings
from measure import arguments, report

_FRAMES = 5
_SECONDS = 20.0
"""No frame is begun after this time; two are measured at least."""


def main() -> None:
    """Print medians: of a frame, from file to stored result, and of an iteration; and what is outside of these."""
    given = arguments()
    import fedic

    mesh = fedic.rectangle_mesh(given.bounds, size=given.size)
    correlator = fedic.Correlator(fedic.read_image(given.reference, mapped=True), mesh, **settings(given))
    frames, full, single = [], [], []
    begin = time.perf_counter()
    while len(frames) < 2 or (len(frames) < _FRAMES and time.perf_counter() - begin < _SECONDS):
        start = time.perf_counter()
        deformed = fedic.read_image(given.deformed, mapped=True)
        read = time.perf_counter()
        result = correlator.correlate(deformed)
        correlated = time.perf_counter()
        result.write(given.out.with_suffix(".npz"))
        frames.append(time.perf_counter() - start)
        full.append(correlated - read)

        start = time.perf_counter()
        again = correlator.correlate(deformed, initial=result.displacement)
        single.append(time.perf_counter() - start)
        if not (result.converged and again.converged and again.iterations < result.iterations):
            sys.exit(f"{result.iterations} iterations from zero, {again.iterations} from the solution")

    more = result.iterations - again.iterations
    iteration = statistics.median(long - short for long, short in zip(full, single, strict=True)) / more
    frame = statistics.median(frames)
    report(
        frames=len(frames),
        frame=frame,
        iteration=iteration,
        outside=frame - result.iterations * iteration,
        iterations=result.iterations,
        points=result.num_points,
    )


if __name__ == "__main__":
    main()
