"""What the scripts that measure share: their arguments, what they print and the field they leave behind.

Runs in the environment of every package compared, and imports nothing of its own that would be timed with them.
"""

import resource
import sys
from pathlib import Path
from typing import Any, NamedTuple

_BYTES_PER_UNIT = 1 if sys.platform == "darwin" else 1024
"""Unit of the peak memory that the system reports."""


class Arguments(NamedTuple):
    """The arguments ``REF DEF X0 Y0 X1 Y1 SIZE THREADS OUT [OPTION]``; `out` is a path without suffix."""

    reference: Path
    deformed: Path
    bounds: tuple[float, float, float, float]
    size: float
    threads: int
    out: Path
    options: list[str]


def arguments() -> Arguments:
    """Read the command line."""
    if len(sys.argv) < 10:
        sys.exit(f"usage: python {Path(sys.argv[0]).name} REF DEF X0 Y0 X1 Y1 SIZE THREADS OUT [OPTION]")
    reference, deformed, out = (Path(sys.argv[index]) for index in (1, 2, 9))
    x0, y0, x1, y1, size = map(float, sys.argv[3:8])
    return Arguments(reference, deformed, (x0, y0, x1, y1), size, int(sys.argv[8]), out, sys.argv[10:])


def megabytes(maxrss: int) -> float:
    """Convert a peak memory as the system reports it."""
    return maxrss * _BYTES_PER_UNIT / 1e6


def report(**values: float) -> None:
    """Print one line of names and values, the peak memory of this process at its end."""
    values["peak_MB"] = megabytes(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    sys.stdout.write(" ".join(f"{name} {value:.6g}" for name, value in values.items()) + "\n")


def save_field(out: Path, points: Any, displacement: Any) -> None:
    """Leave the displacement at points of the image, both (n, 2) and in pixels, in ``OUT.npz``."""
    import numpy as np

    np.savez(out.with_suffix(".npz"), points=points, displacement=displacement)
