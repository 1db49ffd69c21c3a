"""Measure one pair with fedic, images in and files out: python pair_fedic.py REF DEF X0 Y0 X1 Y1 SIZE OUT."""

import time

from measure import arguments, report


def main() -> None:
    """Measure with the defaults, write ``OUT.vtu`` and ``OUT.npz`` and say where the time went."""
    given = arguments()
    clock = {"start": time.perf_counter()}
    import fedic

    clock["import"] = time.perf_counter()
    reference, deformed = fedic.read_image(given.reference), fedic.read_image(given.deformed)
    clock["read"] = time.perf_counter()
    mesh = fedic.rectangle_mesh(given.bounds, size=given.size)
    correlator = fedic.Correlator(reference, mesh)
    clock["prepare"] = time.perf_counter()
    result = correlator.correlate(deformed)
    clock["iterate"] = time.perf_counter()
    for suffix in (".vtu", ".npz"):
        result.write(given.out.with_suffix(suffix))
    clock["write"] = time.perf_counter()

    times = list(clock.values())
    report(
        points=result.num_points,
        dofs=result.displacement.size,
        iterations=result.iterations,
        residual_std=result.residual_std,
        seconds=times[-1] - times[0],
        **{stage: end - begin for stage, begin, end in zip(list(clock)[1:], times[:-1], times[1:], strict=True)},
    )


if __name__ == "__main__":
    main()
