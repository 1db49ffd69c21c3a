"""The kinds of files: small valid ones, and what is done with each mutated one."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import numpy as np

import fedic
from fedic.campaign import load_config
from fedic.registration import read_pairs

__all__ = ["SUITES", "Suite"]

_TOOLS = Path(__file__).parents[2] / "tools"
_LARGEST_SEED = 40_000


@dataclass(frozen=True)
class Suite:
    """One kind of files.

    Attributes
    ----------
    seeds : callable
        Writes small valid files in a folder and returns them.
    use : callable
        Reads a file and uses what it holds.
    """

    seeds: Callable[[Path], list[Path]]
    use: Callable[[Path], object]


def _of_tables(*modules: str) -> Callable[[Path], list[Path]]:
    """Return the files that the generators of the tables of formats write."""

    def write(folder: Path) -> list[Path]:
        if str(_TOOLS) not in sys.path:
            sys.path.insert(0, str(_TOOLS))
        for module in modules:
            (folder / module).mkdir()
            import_module(f"formats.{module}").rows(folder / module)
        files = (path for path in folder.rglob("*") if path.is_file())
        return sorted(path for path in files if 0 < path.stat().st_size <= _LARGEST_SEED)

    return write


def _use_image(path: Path) -> None:
    image = fedic.read_image(path)
    if min(image.shape) >= 24 and image.size < 1 << 20:
        height, width = image.shape
        mesh = fedic.rectangle_mesh((4, 4, width - 5, height - 5), 8)
        fedic.correlate(image, image, mesh, initial="zero", max_iterations=2, num_threads=1)


def _use_mesh(path: Path) -> None:
    mesh = fedic.read_mesh(path)
    mesh.outlines()
    mesh.strains(np.zeros((mesh.num_nodes, 2)))


def _use_camera(path: Path) -> None:
    camera = fedic.read_camera(path)
    with np.errstate(all="ignore"):
        camera.project([[0.0, 0.0, 1.0], [0.1, 0.2, 2.0]])


def _configurations(folder: Path) -> list[Path]:
    image = np.random.default_rng(0).integers(0, 255, (40, 48)).astype(np.uint8)
    for name in ("reference", "frame_1", "frame_2"):
        np.save(folder / f"{name}.npy", image)
    text = """
[images]
reference = "reference.npy"
deformed = "frame_*.npy"

[mesh]
rectangle = { bounds = [8.0, 8.0, 40.0, 32.0], size = 8.0 }

[camera]
model = "pinhole"
focal = [1000.0, 1001.0]
principal_point = [24.0, 20.0]
rotation = [0.01, 0.0, 0.0]
translation = [0.0, 0.0, 1000.0]
distortion = { model = "brown", radial = [-0.1, 0.01, 0.0] }

[correlation]
smoothing = 0.4
max_iterations = 5
initial = "zero"

[output]
folder = "results"
pictures = false
"""
    (folder / "pinhole.toml").write_text(text, encoding="utf-8")
    head, rest = text.split("[camera]")
    tail = rest.split("[correlation]")[1]
    (folder / "frame.toml").write_text(f"{head}[correlation]{tail}", encoding="utf-8")
    return [folder / "pinhole.toml", folder / "frame.toml"]


def _use_configuration(path: Path) -> None:
    config = load_config(path)
    config.mesh.build()
    config.camera.build()


def _pairs(folder: Path) -> list[Path]:
    tables = {
        "plain.txt": "0 0 10 20\n10 0 110 20\n0 10 10 120\n",
        "heading.csv": "x;y;u;v\n0,5;0;10,25;20\n10;0;110;20\n0;10;10;120\n",
        "space.csv": "X,Y,Z,u,v\n0,0,0,10,20\n10,0,1,110,20\n0,10,2,10,120\n",
    }
    for name, text in tables.items():
        (folder / name).write_text(text, encoding="utf-8")
    return [folder / name for name in tables]


SUITES = {
    "images": Suite(_of_tables("images"), _use_image),
    "meshes": Suite(_of_tables("meshes", "finite_element_programs"), _use_mesh),
    "cameras": Suite(_of_tables("cameras"), _use_camera),
    "configurations": Suite(_configurations, _use_configuration),
    "pairs": Suite(_pairs, read_pairs),
}
"""The suites by name."""
