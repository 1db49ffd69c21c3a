"""Folders with images and a configuration for ``fedic run``."""

import hashlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from typer.testing import CliRunner

import fedic
from fedic.cli import app

__all__ = ["contents", "run", "speckle", "write_image", "write_run"]

_MESH = "[mesh.rectangle]\nbounds = [24, 24, 96, 72]\nsize = 12.0\n"


def write_run(
    folder: Path,
    images: list[str],
    *,
    deformed: str = "",
    output: str = "out",
    mesh: str = _MESH,
    pictures: bool = False,
    more: str = "",
) -> Path:
    """Write small images of a moving specimen and a configuration that measures them.

    Parameters
    ----------
    folder : Path
        Receives ``ref.png``, the images and ``test.toml``.
    images : list of str
        Names of the deformed images; the first has moved by 0.3 px, the next by 0.6 px and so on.
    deformed : str
        Value of ``images.deformed``; the list of the images by default.
    output : str
        The output folder.
    mesh : str
        The section of the mesh.
    pictures : bool
        Whether pictures are drawn.
    more : str
        More sections.

    Returns
    -------
    Path
        The configuration.
    """
    write_image(folder / "ref.png", speckle(0.0))
    for number, name in enumerate(images, start=1):
        write_image(folder / name, speckle(0.3 * number))
    listed = ", ".join(f'"{name}"' for name in images)
    path = folder / "test.toml"
    path.write_text(
        f'[images]\nreference = "ref.png"\ndeformed = {deformed or f"[{listed}]"}\n{mesh}'
        f'[output]\nfolder = "{output}"\npictures = {str(pictures).lower()}\nfiles = ["vtu", "npz"]\n{more}'
    )
    return path


def speckle(shift: float) -> NDArray[np.uint8]:
    """Return a small image of a specimen moved to the right by some pixels."""
    image = fedic.synthetic.render(
        fedic.synthetic.Speckle(3.0, seed=2), fedic.ImageFrame(), (96, 120), displacement=(shift, 0.0)
    )
    assert image.dtype == np.uint8
    return image  # type: ignore[return-value]


def write_image(path: Path, image: NDArray[np.uint8]) -> None:
    """Write an image to a file of any name, in the folder made for it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    intact, data = cv2.imencode(".png", image)
    assert intact
    path.write_bytes(data.tobytes())


def contents(folder: Path) -> dict[str, str]:
    """Return a checksum of every file below a folder by its relative name; of a link, that of its target."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def run(config: Path, *arguments: str) -> Any:
    """Call ``fedic run`` in this process; return its exit code and what it printed."""
    return CliRunner().invoke(app, ["run", str(config), *arguments])
