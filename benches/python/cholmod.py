"""Factorize a matrix with CHOLMOD, through scikit-sparse 0.4: python cholmod.py FOLDER ORDER SECONDS.

``FOLDER`` holds a matrix written by the example ``factorize`` of the fedic-sparse crate.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse
from sksparse import cholmod  # type: ignore[import-not-found]


def fastest(run: Callable[[], Any], seconds: float) -> tuple[float, Any]:
    """Return the shortest time of repeated runs, and the last result."""
    begin, best = time.perf_counter(), float("inf")
    while True:
        start = time.perf_counter()
        made = run()
        best = min(best, time.perf_counter() - start)
        if time.perf_counter() - begin > seconds:
            return best, made


def memory(name: str) -> float:
    """Return a field of ``/proc/self/status`` in megabytes."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) * 1.024e-3 for line in lines if line.startswith(name))


def main() -> None:
    """Print the report that the example prints."""
    folder, order, seconds = Path(sys.argv[1]), sys.argv[2], float(sys.argv[3])
    starts, rows = (np.fromfile(folder / f"{name}.i32", dtype="<i4") for name in ("starts", "rows"))
    values = np.fromfile(folder / "values.f64", dtype="<f8")
    dofs = starts.size - 1
    matrix = scipy.sparse.csc_matrix((values, rows, starts), shape=(dofs, dofs))
    symmetric = matrix + scipy.sparse.tril(matrix, -1).T
    exact = np.sin(np.arange(dofs))
    load = symmetric @ exact
    del symmetric
    before = memory("VmRSS")
    symbolic, plan = fastest(lambda: cholmod.analyze(matrix, ordering_method=order, mode="supernodal"), seconds)
    numeric, factor = fastest(lambda: plan.cholesky(matrix), seconds)
    solve, found = fastest(lambda: factor(load), seconds)
    peak = memory("VmHWM") - before
    entries = factor.L().nnz if dofs < 300_000 else float("nan")  # a copy of the factor
    error = np.abs(found - exact).max()
    sys.stdout.write(
        f"dofs {dofs} entries {entries} order {symbolic:.6f} numeric {numeric:.6f} solve {solve:.6f} error {error:.2e} "
        f"peak_MB {peak:.1f}\n"
    )


if __name__ == "__main__":
    main()
