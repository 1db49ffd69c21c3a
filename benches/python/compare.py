"""Compare fedic, published packages and a plain streaming loop over sizes and threads: python compare.py [--help].

Every measurement is a process of its own; its time and memory are those of the whole process, start of the interpreter
and imports included. The packages to compare with pin versions of their own: give the interpreter of an environment
that holds them as --peer-python.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from machine import machine
from make_pair import Pair, default_folder, pair
from rich.console import Console
from table import legend, table
from targets import verdicts

HERE = Path(__file__).parent
RESULTS = HERE.parent / "results" / "comparison.json"
ELEMENT = 20
MILLION = (150.0, 17)
"""Megapixels and size of the elements that make a million unknowns."""
REPETITIONS = 5
SECONDS = 10.0
"""A run of fedic is not repeated any more after this time."""
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""What tells libraries how many threads to use."""

Row = dict[str, Any]


class Package(NamedTuple):
    """A package to compare: script, module, distribution, option of the script, name of the field it leaves."""

    script: str
    module: str
    distribution: str
    option: str = ""
    displacement: str = "displacement"
    series: str = ""

    @property
    def name(self) -> str:
        """Return what its rows are called."""
        return f"{self.distribution} {self.option}".strip()


class Case(NamedTuple):
    """What is measured: a pair, the size of the elements and the number of threads."""

    images: Pair
    element: int
    threads: int


FEDIC, CUBIC = (
    Package("pair_fedic.py", "fedic", "fedic", option, "pixel_displacement", "series_fedic.py")
    for option in ("", "cubic")
)
PEERS = (
    Package("pair_pyvale.py", "pyvale.dic", "pyvale"),
    Package("pair_pyxel.py", "pyxel", "pyxel-dic"),
    Package("pair_pyxel.py", "pyxel", "pyxel-dic", "full"),
)


def launch(command: list[Any], threads: int, folder: Path) -> Row:
    """Run a command as a fresh process; return its time and memory, seen from outside, and what it says."""
    log = folder / "log.txt"
    environment = os.environ | dict.fromkeys(THREAD_VARIABLES, str(threads))
    launcher = [sys.executable, HERE / "launch.py", log, *command]
    seen = subprocess.run(
        [str(part) for part in launcher], cwd=folder, env=environment, check=True, capture_output=True, text=True
    )
    outside = read_report(seen.stdout)
    last = (log.read_text(errors="replace").splitlines() or ["nothing printed"])[-1]
    if (code := outside.pop("exit_code")) != 0:
        return {"failed": f"exit code {code:.0f}: {last}"}
    try:
        return {**outside, "said": read_report(last)}
    except ValueError:
        return {"failed": f"no report: {last}"}


def read_report(line: str) -> dict[str, float | None]:
    """Read a line of names and values; what is no number is None, as in JSON."""
    words = line.split()
    values = map(float, words[1::2])
    return {name: value if math.isfinite(value) else None for name, value in zip(words[::2], values, strict=True)}


def measured(python: str, package: Package, script: str, case: Case, folder: Path) -> Row:
    """Run a script of a package once."""
    out = folder / "out"
    images = case.images
    command = [python, HERE / script, images.reference, images.deformed, *images.bounds, case.element, case.threads]
    command += [out, package.option] if package.option else [out]
    found = launch(command, case.threads, folder)
    return found if "failed" in found else {**found, **errors(out.with_suffix(".npz"), package, images)}


def errors(path: Path, package: Package, images: Pair) -> Row:
    """Return the error in pixels: mean and standard deviation of each component, root mean square of both."""
    with np.load(path) as field:
        points, found = field["points"][:, :2], field[package.displacement]
    error = found - images.displacement(points)
    error = error[np.isfinite(error).all(axis=1)]
    return {
        "error_mean": error.mean(axis=0).tolist(),
        "error_std": error.std(axis=0).tolist(),
        "error_rms": float(np.sqrt((error**2).mean())),
        "measured_at": len(error),
    }


def fedic_row(package: Package, case: Case) -> Row:
    """Run fedic several times where that is short and keep the run of median time; then time the frames of a series."""
    runs: list[Row] = []
    begin = time.perf_counter()
    while len(runs) < REPETITIONS and (not runs or time.perf_counter() - begin < SECONDS):
        with tempfile.TemporaryDirectory() as folder:
            runs.append(measured(sys.executable, package, package.script, case, Path(folder)))
        if "failed" in runs[-1]:
            return runs[-1]
    middle = statistics.median_low(one["seconds"] for one in runs)
    row = next(one for one in runs if one["seconds"] == middle)
    with tempfile.TemporaryDirectory() as folder:
        series = measured(sys.executable, package, package.series, case, Path(folder))
    if "failed" in series:
        return series
    return {**row, "all_seconds": [one["seconds"] for one in runs], "series": series["said"]}


def peer_row(python: str, package: Package, case: Case) -> Row:
    """Run a peer once."""
    with tempfile.TemporaryDirectory() as folder:
        return measured(python, package, package.script, case, Path(folder))


def stream_row(points: float, case: Case) -> Row:
    """Time the reading of what an iteration reads."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, HERE / "stream.py", round(points), math.prod(case.images.shape), case.threads]
        found = launch(command, case.threads, Path(folder))
    return found if "failed" in found else {"said": found["said"]}


def version(python: str, package: Package) -> str | None:
    """Return the version of a package in the environment of an interpreter, or None where it cannot be imported.

    The import also spares the run that follows the first reading of its files from the disk.
    """
    code = f"import {package.module}, importlib.metadata as m; print(m.version({package.distribution!r}))"
    with tempfile.TemporaryDirectory() as folder:
        try:
            found = subprocess.run([python, "-c", code], cwd=folder, capture_output=True, text=True, check=False)
        except OSError:
            return None
    return found.stdout.split()[-1] if found.returncode == 0 else None


def command_line() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--megapixels", type=float, nargs="+", default=[1.0, 5.0, 20.0, 80.0, 150.0], help="sizes")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--peer-python", default=sys.executable, help="interpreter that has the other packages")
    parser.add_argument(
        "--peer-megapixels", type=float, default=5.0, help="largest size given to them; 0 for fedic alone"
    )
    parser.add_argument("--folder", type=Path, default=default_folder(), help="where the images are kept")
    parser.add_argument("--output", type=Path, default=RESULTS, help="JSON file to write")
    given = parser.parse_args()
    if given.output.is_dir():
        parser.error(f"--output {given.output} is a folder")
    given.output.parent.mkdir(parents=True, exist_ok=True)
    if os.sep in given.peer_python:
        # Measurements run in a folder of their own. Not resolved: the link in an environment is what makes it one.
        given.peer_python = os.path.abspath(given.peer_python)  # noqa: PTH100
    return given


def plan(megapixels: float, peer_megapixels: float) -> list[tuple[Package, int]]:
    """Return the packages to run at a size, with the size of the elements."""
    million = [(FEDIC, MILLION[1])] if megapixels == MILLION[0] else []
    peers = [(peer, ELEMENT) for peer in PEERS] if megapixels <= peer_megapixels else []
    return [(FEDIC, ELEMENT), (CUBIC, ELEMENT), *million, *peers]


def rows_of(images: Pair, threads: int, planned: list[tuple[Package, int]], python: str) -> Iterator[Row]:
    """Measure everything planned for a pair, then the streaming loop over as many points as fedic had."""
    points: float | None = None
    for package, element in planned:
        interpreter = sys.executable if package.series else python
        installed = version(interpreter, package)
        case = Case(images, element, threads)
        row: Row = {"package": package.name, "threads": threads, "element_px": element, "version": installed}
        if installed is None:
            row |= {"absent": f"pip install {package.distribution}, then --peer-python"}
        else:
            row |= fedic_row(package, case) if package.series else peer_row(interpreter, package, case)
        if package == FEDIC and element == ELEMENT and "said" in row:
            points = row["said"]["points"]
        yield row
    if points is not None:
        case = Case(images, ELEMENT, threads)
        yield {"package": "stream", "threads": threads, "element_px": ELEMENT, **stream_row(points, case)}


def main() -> int:
    """Measure every size and number of threads, then show all rows and what they say of the targets."""
    given = command_line()
    described = machine()
    folder = given.folder.resolve()
    rows: list[Row] = []
    console = Console(width=None if sys.stdout.isatty() else 120)
    with console.status("") as status:
        for megapixels in given.megapixels:
            status.update(f"{megapixels:g} Mpx: images ...")
            images = pair(megapixels, folder)
            making = ["make_pair.py", "--megapixels", str(megapixels), "--folder", str(folder)]
            subprocess.run([sys.executable, *making], check=True, stdout=subprocess.DEVNULL, cwd=HERE)
            height, width = images.shape
            for threads in given.threads:
                planned = plan(megapixels, given.peer_megapixels)
                status.update(f"{megapixels:g} Mpx, threads: {threads} ...")
                for row in rows_of(images, threads, planned, given.peer_python):
                    rows.append({"megapixels": megapixels, "width": width, "height": height, **row})
                    saved = {"machine": described, "rows": rows}
                    given.output.write_text(json.dumps(saved, indent=2, allow_nan=False) + "\n")
    console.print(table(rows))
    console.print(legend(rows), highlight=False, markup=False)
    for verdict in verdicts(rows):
        console.print(verdict, highlight=False)
    console.print(f"Written to {given.output.name}.")
    return 1 if any("failed" in row for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
