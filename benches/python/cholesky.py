"""Compare the Cholesky factorization with CHOLMOD on the same matrices: python cholesky.py [--help].

The matrices are those of a grid of quads and of a mesh of triangles with a hole, with two degrees of freedom per node.
Each factorization runs in its own process. Reported are the shortest time of its repetitions and the growth of its peak
memory.
"""

import argparse
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from compare import THREAD_VARIABLES, read_report
from numpy.typing import NDArray
from rich import box
from rich.console import Console
from rich.table import Table

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
EXAMPLE = ROOT / "target" / "release" / "examples" / "factorize"
PEER_ORDERS = ("amd", "metis", "nesdis")
COLUMNS = ("mesh", "dofs", "threads", "package", "million in L", "order s", "numeric s", "solve s", "peak MB")

Row = dict[str, Any]


def quads(dofs: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return nodes and cells of a square grid."""
    side = round((dofs / 2) ** 0.5)
    y, x = np.mgrid[:side, :side].astype(np.float64)
    node = np.arange(side * side).reshape(side, side)
    cells = np.stack([node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]], axis=-1)
    return np.column_stack([x.ravel(), y.ravel()]), cells.reshape(-1, 4)


def triangles(dofs: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return nodes and cells of a square with a round hole, meshed by gmsh."""
    import fedic

    angle = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    hole = 0.5 + 0.2 * np.column_stack([np.cos(angle), np.sin(angle)])
    outline = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    size = ((1.0 - np.pi * 0.2**2) / (dofs / 2) * 2.0 / 3.0**0.5) ** 0.5
    mesh = fedic.unstructured_mesh(outline, size=size, cell="triangle", holes=[hole])
    return mesh.points[:, :2], np.asarray(mesh.cells["triangle"])


def save(folder: Path, points: NDArray[np.float64], cells: NDArray[np.int64]) -> None:
    """Write a mesh in the format of the Rust example."""
    np.ascontiguousarray(points, dtype="<f8").tofile(folder / "points.f64")
    np.concatenate([[cells.shape[1]], cells.ravel()]).astype("<u4").tofile(folder / "cells.u32")


def run(command: list[Any], threads: int) -> Row:
    """Run a factorization and return its report, or the reason of its failure."""
    environment = os.environ | dict.fromkeys(THREAD_VARIABLES, str(threads))
    found = subprocess.run(
        [str(part) for part in command], env=environment, check=False, capture_output=True, text=True
    )
    if found.returncode != 0:
        return {"absent": (found.stderr.splitlines() or ["failed"])[-1]}
    report = {name: math.nan if value is None else value for name, value in read_report(found.stdout).items()}
    return {"threads": threads, **report}


def shown(rows: list[tuple[str, str, Row]]) -> Table:
    """Tabulate the rows, with the ratio of each figure to the best of CHOLMOD on the same mesh."""
    table = Table(title="Cholesky factorization; in brackets: relative to the best of CHOLMOD", box=box.SIMPLE_HEAD)
    for column in COLUMNS:
        table.add_column(column, justify="left" if column in ("mesh", "package") else "right", no_wrap=True)
    for mesh, package, row in rows:
        if "absent" in row:
            table.add_row(mesh, "", "", package, row["absent"])
            continue
        peers = [
            other
            for name, label, other in rows
            if name == mesh and label.startswith("CHOLMOD") and "absent" not in other
        ]

        def cell(key: str, form: str, row: Row = row, peers: list[Row] = peers) -> str:
            best = min((peer[key] for peer in peers if np.isfinite(peer[key])), default=None)
            return format(row[key], form) + (f" ({row[key] / best:.2f})" if best else "")

        figures = (("entries", ".4g"), ("order", ".4f"), ("numeric", ".4f"), ("solve", ".4f"), ("peak_MB", ".0f"))
        scaled = {**row, "entries": row["entries"] * 1e-6}
        millions = [{**peer, "entries": peer["entries"] * 1e-6} for peer in peers]
        cells = [cell(key, form, scaled, millions) for key, form in figures]
        table.add_row(mesh, format(row["dofs"], ".0f"), str(row["threads"]), package, *cells)
    return table


def main() -> None:
    """Measure fedic and CHOLMOD, with each of its orderings, on every mesh and number of threads; print one table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--dofs", type=float, nargs="+", default=[1e4, 1e5, 1e6], help="approximate degrees of freedom")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--seconds", type=float, default=3.0, help="duration of the repetitions of each step")
    parser.add_argument("--peer-python", default=sys.executable, help="interpreter with scikit-sparse 0.4")
    given = parser.parse_args()
    build = ["cargo", "build", "--quiet", "--release", "--package", "fedic-sparse", "--example", EXAMPLE.name]
    subprocess.run(build, cwd=ROOT, check=True)
    rows: list[tuple[str, str, Row]] = []
    for name, make in (("quads", quads), ("triangles", triangles)):
        for dofs in given.dofs:
            with tempfile.TemporaryDirectory() as temporary:
                folder = Path(temporary)
                save(folder, *make(int(dofs)))
                mesh = f"{name} {dofs:.0e}"
                for precision in ("double", "compact"):
                    for threads in given.threads:
                        row = run([EXAMPLE, folder, threads, given.seconds, precision], threads)
                        rows.append((mesh, f"fedic {precision}", row))
                for order in PEER_ORDERS:
                    for threads in given.threads:
                        command = [given.peer_python, HERE / "cholmod.py", folder, order, given.seconds]
                        rows.append((mesh, f"CHOLMOD {order}", run(command, threads)))
    Console(width=None if sys.stdout.isatty() else 140).print(shown(rows))


if __name__ == "__main__":
    main()
