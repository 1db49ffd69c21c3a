"""Time a campaign against the bare correlations of its frames: python campaign.py [--frames 200] [--megapixels 5].

Campaign: files in, VTKHDF out with strains, quality and standard deviations, no pictures. Bare correlations: the same
frames one after the other, each from the result of the frame before; only the calls of `correlate` are timed. Both run
in turns, in processes of their own. With --peer-python the packages of compare.py measure three of the frames; the time
of one is that of its whole process, as they prepare the reference each time.
"""

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np
import tifffile
from rich.console import Console

HERE = Path(__file__).parent
TURNS = 3
ELEMENT = 20
MARGIN = 50


def say(text: str) -> None:
    """Print a line."""
    Console().print(text, highlight=False)


def main() -> None:
    """Print the times, their ratios and the peak memory."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--megapixels", type=float, default=5.0)
    parser.add_argument("--peer-python", type=Path)
    parser.add_argument("--role", choices=("campaign", "bare"), help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.role:
        sys.stdout.write(json.dumps(measured(given.role, given.folder, given.frames)))
        return
    with tempfile.TemporaryDirectory() as folder:
        files = write_frames(Path(folder), given.frames, given.megapixels)
        campaigns, bare = [], []
        for _ in range(TURNS):
            campaigns.append(process("campaign", Path(folder), given.frames))
            bare.append(process("bare", Path(folder), given.frames))
        short = process("campaign", Path(folder), max(given.frames // 10, 2))
        whole, sum_of_frames = (statistics.median(row["seconds"] for row in rows) for rows in (campaigns, bare))
        say(f"{given.frames} frames of {given.megapixels:g} megapixels, {len(files)} files")
        say(f"campaign {whole:.2f} s, {whole / given.frames * 1e3:.1f} ms a frame")
        say(f"bare correlations {sum_of_frames:.2f} s; ratio {whole / sum_of_frames:.2f}")
        ratio = campaigns[0]["megabytes"] / short["megabytes"]
        say(f"peak memory {campaigns[0]['megabytes']:.0f} MB; relative to a tenth of the frames {ratio:.2f}")
        if given.peer_python:
            compare_with_peers(given.peer_python, files, whole / given.frames)


def write_frames(folder: Path, count: int, megapixels: float) -> list[Path]:
    """Write a reference and frames with a growing affine motion, a wobble, and noise of one grey level, unsaturated."""
    height = round((1e6 * megapixels / 1.2) ** 0.5)
    width = round(1.2 * height)
    rng = np.random.default_rng(3)
    texture = cv2.GaussianBlur(rng.normal(0, 1, (height + 80, width + 80)).astype(np.float32), (0, 0), 1.8)
    texture = 128 + 22 * texture / texture.std()
    noise = rng.normal(0, 1, (height + 400, width + 400)).astype(np.float32)
    files = []
    for number in range(count + 1):
        share = number / count
        along = [1 - 0.01 * share, 0.002 * share, 40 + 3 * share + 0.3 * np.sin(number)]
        matrix = np.array([along, [0, 1 + 0.003 * share, 40 + 5 * share]])
        flags = cv2.INTER_LANCZOS4 | cv2.WARP_INVERSE_MAP
        image = cv2.warpAffine(texture, matrix, (width, height), flags=flags)
        row, column = rng.integers(400, size=2)
        image += noise[row : row + height, column : column + width]
        files.append(folder / f"frame_{number:04d}.tif")
        tifffile.imwrite(files[-1], np.clip(np.rint(image), 0, 255).astype(np.uint8), photometric="minisblack")
    return files


def process(role: str, folder: Path, frames: int) -> dict[str, float]:
    """Measure in a process of its own."""
    command = [
        sys.executable,
        str(HERE / "campaign.py"),
        "--role",
        role,
        "--folder",
        str(folder),
        "--frames",
        str(frames),
    ]
    outcome = subprocess.run(command, check=True, capture_output=True, text=True)
    return dict(json.loads(outcome.stdout))


def measured(role: str, folder: Path, frames: int) -> dict[str, float]:
    """Return seconds and peak memory in megabytes of a campaign, or of the bare correlations."""
    import fedic

    files = [folder / f"frame_{number:04d}.tif" for number in range(frames + 1)]
    height, width = tifffile.imread(files[0]).shape
    mesh = fedic.rectangle_mesh((MARGIN, MARGIN, width - MARGIN, height - MARGIN), ELEMENT)
    if role == "campaign":
        start = time.perf_counter()
        store = folder / "results.vtkhdf"
        campaign = fedic.Campaign(files[0], files[1:], mesh, store=store, times=1.0)
        campaign.run(overwrite=True, progress=False)
        seconds = time.perf_counter() - start
        assert all(record.converged for record in campaign.frames)
    else:
        correlator = fedic.Correlator(fedic.read_image(files[0]), mesh)
        result: fedic.Result | None = None
        seconds = 0.0
        for file in files[1:]:
            image = fedic.read_image(file)
            start = time.perf_counter()
            result = correlator.correlate(image, result)
            seconds += time.perf_counter() - start
    return {"seconds": seconds, "megabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0}


def compare_with_peers(python: Path, files: list[Path], seconds: float) -> None:
    """Print how many times longer other packages take for a frame."""
    height, width = tifffile.imread(files[0]).shape
    bounds = [MARGIN, MARGIN, width - MARGIN, height - MARGIN]
    chosen = [files[len(files) // 4], files[len(files) // 2], files[-1]]
    for script, option in (("pair_pyvale.py", ""), ("pair_pyxel.py", "")):
        times = []
        for deformed in chosen:
            out = files[0].with_name("peer")
            command = [python, HERE / script, files[0], deformed, *bounds, ELEMENT, 2, out, option]
            start = time.perf_counter()
            subprocess.run([str(part) for part in command if part != ""], check=True, capture_output=True)
            times.append(time.perf_counter() - start)
        took = statistics.median(times)
        say(f"{script.removeprefix('pair_').removesuffix('.py')}: {took:.1f} s a frame, {took / seconds:.0f} times")


if __name__ == "__main__":
    main()
