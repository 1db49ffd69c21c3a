"""Read once what an iteration reads from memory, and nothing else: python stream.py POINTS PIXELS THREADS.

Twelve bytes per quadrature point (grey level and gradient of the reference image) and four per pixel (coefficients of
the deformed one), added up by NumPy: no iteration can be faster.
"""

import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

_CHUNK = 1 << 16
_REPETITIONS = 10


def main() -> None:
    """Print the seconds of the fastest of some passes."""
    points, pixels, threads = map(int, sys.argv[1:])
    numbers = np.ones(3 * points + pixels, dtype=np.float32)
    parts = np.array_split(numbers, threads)

    def total(part: "np.ndarray[tuple[int], np.dtype[np.float32]]") -> float:
        return sum(float(part[start : start + _CHUNK].sum()) for start in range(0, len(part), _CHUNK))

    with ThreadPoolExecutor(threads) as pool:
        best = float("inf")
        for _ in range(_REPETITIONS):
            start = time.perf_counter()
            list(pool.map(total, parts))
            best = min(best, time.perf_counter() - start)
    sys.stdout.write(f"points {points} iteration {best:.6g}\n")


if __name__ == "__main__":
    main()
