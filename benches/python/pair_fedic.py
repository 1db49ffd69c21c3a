"""Measure a pair with fedic, from files to files: python pair_fedic.py REF DEF X0 Y0 X1 Y1 SIZE THREADS OUT [cubic]."""

import sys
import time

from fedic_settings import settings
from measure import arguments, report


def main() -> None:
    """Measure, write ``OUT.vtu`` and ``OUT.npz`` and say where the time went."""
    given = arguments()
    clock = {"start": time.perf_counter()}
    import fedic

    clock["import"] = time.perf_counter()
    reference, deformed = fedic.read_image(given.reference, mapped=True), fedic.read_image(given.deformed, mapped=True)
    clock["read"] = time.perf_counter()
    mesh = fedic.rectangle_mesh(given.bounds, size=given.size)
    correlator = fedic.Correlator(reference, mesh, **settings(given))
    clock["prepare"] = time.perf_counter()
    result = correlator.correlate(deformed)
    clock["correlate"] = time.perf_counter()
    for suffix in (".vtu", ".npz"):
        result.write(given.out.with_suffix(suffix))
    clock["write"] = time.perf_counter()
    if not result.converged:
        sys.exit(f"not converged after {result.iterations} iterations")

    times = list(clock.values())
    report(
        points=result.num_points,
        unknowns=result.displacement.size,
        iterations=result.iterations,
        residual_rms=result.residual_rms,
        seconds=times[-1] - times[0],
        **{stage: end - begin for stage, begin, end in zip(list(clock)[1:], times[:-1], times[1:], strict=True)},
    )


if __name__ == "__main__":
    main()
