"""Small series of images of a moving specimen."""

from functools import lru_cache
from pathlib import Path

import numpy as np
import tifffile
from numpy.typing import NDArray

import fedic

__all__ = ["MESH", "STEP", "TINY", "frame", "frames", "write_frames"]

STEP = (0.8, -0.3)
"""Motion from frame to frame, in pixels."""
MESH = fedic.rectangle_mesh((24.0, 24.0, 120.0, 120.0), 16.0)
TINY = {"smoothing": 0.0, "interpolation": "bspline3"}
"""Options that save time where accuracy does not matter."""

_SHAPE = (144, 144)


@lru_cache(maxsize=64)
def frame(number: float, seed: int = 1, noise: float = 1.0) -> NDArray[np.uint8]:
    """Return the image of a specimen that has moved by some steps; number 0 is at rest."""
    texture, camera = fedic.synthetic.Speckle(4.0, seed=seed), fedic.ImageFrame()
    motion = (STEP[0] * number, STEP[1] * number)
    clean = fedic.synthetic.render(texture, camera, _SHAPE, displacement=motion).astype(np.float64)
    scatter = np.random.default_rng(int(1000 * number) + seed).normal(0.0, noise, _SHAPE)
    image = np.clip(np.rint(clean + scatter), 0, 255).astype(np.uint8)
    image.flags.writeable = False
    return image


def frames(count: int) -> list[NDArray[np.uint8]]:
    """Return the frames 1 to ``count``."""
    return [frame(number) for number in range(1, count + 1)]


def write_frames(folder: Path, count: int) -> list[Path]:
    """Write the reference and the frames 1 to ``count``; return their files."""
    folder.mkdir(exist_ok=True, parents=True)
    files = [folder / f"frame_{number:03d}.tif" for number in range(count + 1)]
    for number, file in enumerate(files):
        tifffile.imwrite(file, frame(number), photometric="minisblack")
    return files
