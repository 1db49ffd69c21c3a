"""Read once what an iteration must read from memory, and nothing else: python stream.py POINTS PIXELS THREADS.

Nine bytes per quadrature point (grey level and gradient of the reference image) and four per pixel (coefficients of
the deformed one), each thread a part of them. NumPy's maximum is the fastest plain loop it has over single precision,
faster than its sum, which adds by pairs: no iteration can be faster.
"""

import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from measure import report

_REPETITIONS = 10


def main() -> None:
    """Print the seconds of the fastest of some passes."""
    points, pixels, threads = map(int, sys.argv[1:])
    numbers = np.ones(9 * points // 4 + pixels, dtype=np.float32)
    parts = np.array_split(numbers, threads)
    best = float("inf")
    with ThreadPoolExecutor(threads) as pool:
        for _ in range(_REPETITIONS):
            start = time.perf_counter()
            list(pool.map(np.max, parts))
            best = min(best, time.perf_counter() - start)
    report(points=points, iteration=best, GB_per_second=numbers.nbytes / best / 1e9)


if __name__ == "__main__":
    main()
