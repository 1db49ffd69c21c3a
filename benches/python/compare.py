"""Compare fedic with published packages on one pair, each in a process of its own: python compare.py [--help].

The last rows are a plain loop over the memory of an iteration, the limit of any.

Times and memory are those of the whole process, start of the interpreter and imports included. The packages to compare
with pin versions of their own: give the interpreter of an environment that holds them as --peer-python.
"""

import argparse
import datetime
import importlib.metadata
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from make_pair import Pair, default_folder, pair
from measure import megabytes
from rich.console import Console
from rich.table import Table

HERE = Path(__file__).parent
ELEMENT = 20


class Package(NamedTuple):
    """A package to compare: script, module, distribution, option of the script, name of the field it leaves."""

    script: str
    module: str
    distribution: str
    options: tuple[str, ...] = ()
    displacement: str = "displacement"

    @property
    def name(self) -> str:
        """Return what its row is called."""
        return " ".join((self.distribution, *self.options))


def fedic_with(*options: str) -> Package:
    """Return fedic with some options of its script."""
    return Package("pair_fedic.py", "fedic", "fedic", options, displacement="pixel_displacement")


FEDIC = (fedic_with(), fedic_with("cubic"), fedic_with("one-thread"), fedic_with("cubic", "one-thread"))
SERIES = fedic_with("series")
PEERS = (
    Package("pair_pyvale.py", "pyvale.dic", "pyvale"),
    Package("pair_pyxel.py", "pyxel", "pyxel-dic"),
    Package("pair_pyxel.py", "pyxel", "pyxel-dic", ("full",)),
)


def run(python: str, package: Package, images: Pair, folder: Path) -> dict[str, Any]:
    """Run one measurement; return what it says, its time and memory seen from outside, and its error."""
    out = folder / package.name.replace(" ", "-")
    command = [python, HERE / package.script, images.reference, images.deformed, *images.bounds, ELEMENT, out]
    command += package.options
    log = out.with_suffix(".log")
    # A new process counts the memory of the one that starts it as its own peak: this one must stay small.
    with log.open("w") as output:
        start = time.perf_counter()
        process = subprocess.Popen([str(part) for part in command], stdout=output, stderr=subprocess.STDOUT, cwd=folder)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    lines = log.read_text().splitlines()
    if process.returncode != 0:
        return {"failed": lines[-1] if lines else f"exit code {process.returncode}"}
    words = lines[-1].split()
    return {
        "seconds": seconds,
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "peak_MB": megabytes(usage.ru_maxrss),
        "said": {name: float(value) for name, value in zip(words[::2], words[1::2], strict=True)},
        **errors(out.with_suffix(".npz"), package, images),
    }


def errors(path: Path, package: Package, images: Pair) -> dict[str, Any]:
    """Return mean and standard deviation of the error of each component, in pixels, and where it is known."""
    with np.load(path) as field:
        points, found = field["points"][:, :2], field[package.displacement]
    error = found - images.displacement(points)
    known = np.isfinite(error).all(axis=1)
    mean, deviation = error[known].mean(axis=0), error[known].std(axis=0)
    return {"error_mean": mean.tolist(), "error_std": deviation.tolist(), "measured_at": int(known.sum())}


def repeated(python: str, package: Package, images: Pair, folder: Path, repetitions: int) -> dict[str, Any]:
    """Run several times; return the run of median time, and all times."""
    runs = [run(python, package, images, folder) for _ in range(repetitions)]
    failed = [one for one in runs if "failed" in one]
    if failed:
        return failed[0]
    middle = statistics.median_low(one["seconds"] for one in runs)
    return {**next(one for one in runs if one["seconds"] == middle), "all_seconds": [one["seconds"] for one in runs]}


def stream(points: int, pixels: int, threads: int) -> dict[str, Any]:
    """Time the reading of what an iteration reads."""
    command = [sys.executable, str(HERE / "stream.py"), str(points), str(pixels), str(threads)]
    words = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    return {"said": {name: float(value) for name, value in zip(words[::2], words[1::2], strict=True)}}


def version(python: str, package: Package) -> str | None:
    """Return the version of a package in the environment of an interpreter, or None where it cannot be imported.

    The import also spares the run that follows the first reading of its files from the disk.
    """
    code = f"import {package.module}, importlib.metadata as m; print(m.version({package.distribution!r}))"
    found = subprocess.run([python, "-c", code], capture_output=True, text=True, check=False)
    return found.stdout.split()[-1] if found.returncode == 0 else None


def machine() -> dict[str, Any]:
    """Describe the machine, without a name."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = (line.split(":", 1)[1] for line in cpuinfo.read_text().splitlines() if line.startswith("model name"))
        model = next(names, model).strip()
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    versions = {name: importlib.metadata.version(name) for name in ("fedic", "numpy")}
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).date().isoformat(),
        "cpu": model,
        "cores": os.cpu_count(),
        "memory_GB": round(memory, 1),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        **versions,
    }


def table(title: str, rows: dict[str, dict[str, Any]]) -> Table:
    """Lay the results out."""
    notes: list[str] = []
    shown = Table(title=title)
    shown.add_column("package")
    headings = (
        "seconds",
        "of fedic",
        "peak MB",
        "points",
        "ns/point/iteration",
        "error of u: mean, std (px)",
        "error of v",
    )
    for heading in headings:
        shown.add_column(heading, justify="right")
    reference = rows["fedic"].get("seconds", float("nan"))
    for name, row in rows.items():
        label = f"{name} {row['version']}" if row.get("version") else name
        said = row.get("said", {})
        each = f"{said['iteration'] / said['points'] * 1e9:.2f}" if "iteration" in said else ""
        if name.startswith("stream"):
            shown.add_row(label, "", "", "", f"{said['points']:.3g}", each)
            continue
        if "seconds" not in row:
            problem = f"not installed: {row['missing']}" if "missing" in row else f"failed: {row['failed']}"
            notes.append(f"{label} {problem}")
            continue
        pairs = zip(row["error_mean"], row["error_std"], strict=True)
        shown.add_row(
            label,
            f"{row['seconds']:.2f}",
            f"{row['seconds'] / reference:.2f}",
            f"{row['peak_MB']:.0f}",
            f"{said['points']:.3g}",
            each,
            *(f"{mean:+.4f}, {deviation:.4f}" for mean, deviation in pairs),
        )
    shown.caption = "\n".join(notes)
    return shown


def command_line() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--megapixels", type=float, default=5.0, help="size of the images")
    parser.add_argument("--peer-python", default=sys.executable, help="interpreter that has the other packages")
    parser.add_argument("--repetitions", type=int, default=5, help="runs of fedic; the others run once")
    parser.add_argument("--no-peers", action="store_true", help="run fedic alone")
    parser.add_argument("--folder", type=Path, default=default_folder(), help="where the images are kept")
    parser.add_argument("--output", type=Path, help="JSON file to write [benches/results/pair_<size>mpx.json]")
    return parser.parse_args()


def main() -> int:
    """Make the pair, run every package, show and save the results."""
    given = command_line()
    images = pair(given.megapixels, given.folder.resolve())
    # In its own process, so that the memory it takes is not counted as that of the measurements.
    making = ["make_pair.py", "--megapixels", str(given.megapixels), "--folder", str(given.folder.resolve())]
    subprocess.run([sys.executable, *making], check=True, stdout=subprocess.DEVNULL, cwd=HERE)
    console = Console(width=None if sys.stdout.isatty() else 120)
    rows: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as folder:
        plan = [(package, sys.executable, given.repetitions) for package in FEDIC]
        plan += [(SERIES, sys.executable, 1)]
        plan += [] if given.no_peers else [(peer, given.peer_python, 1) for peer in PEERS]
        for package, python, repetitions in plan:
            installed = version(python, package)
            if installed is None:
                rows[package.name] = {"missing": f"pip install {package.distribution}, then --peer-python"}
                continue
            with console.status(f"{package.name} ..."):
                found = repeated(python, package, images, Path(folder), repetitions)
            rows[package.name] = {"version": installed, **found}
    height, width = images.shape
    if "said" in rows["fedic"]:
        for threads in (2, 1):
            points = round(rows["fedic"]["said"]["points"])
            rows[f"stream, threads: {threads}"] = stream(points, height * width, threads)
    console.print(table(f"{width} x {height} px, elements of {ELEMENT} px", rows))
    output = given.output or HERE.parent / "results" / f"pair_{given.megapixels:g}mpx.json"
    output.parent.mkdir(parents=True, exist_ok=True)
    saved = {"machine": machine(), "width": width, "height": height, "element_px": ELEMENT, "packages": rows}
    output.write_text(json.dumps(saved, indent=2) + "\n")
    frame = rows[SERIES.name].get("said", {})
    if "frame" in frame:
        console.print(
            f"Next frame of a series, from its file to its stored result: {frame['frame']:.3f} s, "
            f"{frame['frame_outside'] / frame['frame']:.0%} of it outside the iterations."
        )
    console.print(f"Written to {output.name}.")
    return 1 if any("failed" in row for row in rows.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
