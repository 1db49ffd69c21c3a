"""Measure one pair with fedic, images in and files out: python pair_fedic.py REF DEF X0 Y0 X1 Y1 SIZE OUT [OPTION ...].

Options: ``cubic`` for cubic B-splines without prefilter instead of the defaults, ``one-thread``, and ``series`` to
measure the deformed image again, as the next frames of a series, when the pair is done.
"""

import statistics
import time
from pathlib import Path
from typing import Any

from measure import arguments, report

_FRAMES = 5


def main() -> None:
    """Measure, write ``OUT.vtu`` and ``OUT.npz`` and say where the time went."""
    given = arguments()
    clock = {"start": time.perf_counter()}
    import fedic

    clock["import"] = time.perf_counter()
    reference, deformed = fedic.read_image(given.reference), fedic.read_image(given.deformed)
    clock["read"] = time.perf_counter()
    mesh = fedic.rectangle_mesh(given.bounds, size=given.size)
    settings: dict[str, Any] = {"interpolation": "bspline3", "prefilter": 0.0} if "cubic" in given.options else {}
    if "one-thread" in given.options:
        settings["num_threads"] = 1
    correlator = fedic.Correlator(reference, mesh, **settings)
    clock["prepare"] = time.perf_counter()
    ticks: list[float] = []
    result = correlator.correlate(deformed, progress=lambda *_: ticks.append(time.perf_counter()))
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
        iteration=_per_iteration(ticks),
        **{stage: end - begin for stage, begin, end in zip(list(clock)[1:], times[:-1], times[1:], strict=True)},
        **(_series(correlator, given.deformed, given.out) if "series" in given.options else {}),
    )


def _series(correlator: Any, path: Path, out: Path) -> dict[str, float]:
    """Return the seconds of a frame from its file to its stored result, and of what lies outside its iterations."""
    import fedic

    frames, outside = [], []
    for _ in range(_FRAMES):
        ticks: list[float] = []
        start = time.perf_counter()
        result = correlator.correlate(
            fedic.read_image(path), progress=lambda *_, ticks=ticks: ticks.append(time.perf_counter())
        )
        result.write(out.with_suffix(".npz"))
        frames.append(time.perf_counter() - start)
        outside.append(frames[-1] - result.iterations * _per_iteration(ticks))
    return {"frame": statistics.median(frames), "frame_outside": statistics.median(outside)}


def _per_iteration(ticks: list[float]) -> float:
    """Return the seconds of an iteration; the first one is left out, for the preparation of the image precedes it."""
    return (ticks[-1] - ticks[0]) / (len(ticks) - 1) if len(ticks) > 1 else float("nan")


if __name__ == "__main__":
    main()
