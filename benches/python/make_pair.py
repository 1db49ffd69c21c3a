"""Make the synthetic pair that the packages are compared on: python make_pair.py [--megapixels 5] [--folder FOLDER].

A speckle on a flat specimen, at rest and after a smooth stretch and shift of at most three pixels at any size, small
enough for every package to converge from zero. 8 bits, uncompressed TIFF. A pair is made once and kept by its name.
"""

import argparse
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ASPECT = 2448 / 2048
MARGIN = 100
"""Pixels between the border of the image and the region measured."""
SPECKLE_SIZE = 5.0
SHIFT = np.array([0.9, -0.6])
LARGEST_STRETCH = np.array([1.2, -0.8])
"""Displacement, in pixels, that the stretch adds at the edges of the image: 1e-3 for 5 megapixels."""
WAVE = np.array([0.3, 0.2])
"""Amplitude, in pixels, of a wave of one period across the image."""
BAND_PIXELS = 4_000_000
"""Pixels rendered at once: a whole image of 150 megapixels would take gigabytes."""


class Pair(NamedTuple):
    """Two images in files, the region to measure and what truly happened."""

    shape: tuple[int, int]
    reference: Path
    deformed: Path

    @property
    def bounds(self) -> tuple[int, int, int, int]:
        """Return ``x0, y0, x1, y1`` of the region, in pixels."""
        height, width = self.shape
        return MARGIN, MARGIN, width - MARGIN, height - MARGIN

    def displacement(self, points: Floats) -> Floats:
        """Return the displacement, in pixels, of points (n, 2) of the image at rest."""
        half = 0.5 * np.array(self.shape[::-1], dtype=np.float64)
        along = (points - half) / half
        displacement: Floats = SHIFT + LARGEST_STRETCH * along + WAVE * np.sin(np.pi * along[:, ::-1])
        return displacement


def pair(megapixels: float, folder: Path) -> Pair:
    """Return the pair of this size in `folder`, whether or not it has been made."""
    height = max(2 * MARGIN + 100, round((megapixels * 1e6 / ASPECT) ** 0.5 / 16) * 16)
    shape = (height, round(height * ASPECT / 16) * 16)
    name = f"pair_{shape[1]}x{shape[0]}"
    return Pair(shape, folder / f"{name}_reference.tif", folder / f"{name}_deformed.tif")


def make(wanted: Pair) -> None:
    """Render and write those of the two images that are missing."""
    import tifffile

    for path, displacement in ((wanted.reference, None), (wanted.deformed, wanted.displacement)):
        if path.exists():
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(".part")
        tifffile.imwrite(unfinished, rendered(wanted.shape, displacement))
        unfinished.replace(path)


def rendered(shape: tuple[int, int], displacement: Callable[[Floats], Floats] | None) -> NDArray[np.uint8]:
    """Render an image band by band, each through a camera moved down to it."""
    import fedic

    texture = fedic.synthetic.Speckle(SPECKLE_SIZE, seed=3)
    upwards = np.array([1.0, -1.0])
    """From the image, where y goes down, to the world of the camera and back."""

    def moved(points: Floats) -> Floats:
        assert displacement is not None
        return upwards * displacement(upwards * points)

    height, width = shape
    rows = max(1, BAND_PIXELS // width)
    image = np.empty(shape, dtype=np.uint8)
    for first in range(0, height, rows):
        band = image[first : first + rows]
        camera = fedic.FrontParallel(1.0, (0.0, -float(first)))
        band[:] = fedic.synthetic.render(
            texture, camera, band.shape, displacement=None if displacement is None else moved, supersampling=2
        )
    return image


def default_folder() -> Path:
    """Return where pairs are kept."""
    return Path(tempfile.gettempdir()) / "fedic-benches"


def main() -> None:
    """Make the pair and print where it is and what to measure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--megapixels", type=float, default=5.0)
    parser.add_argument("--folder", type=Path, default=default_folder())
    given = parser.parse_args()
    made = pair(given.megapixels, given.folder)
    make(made)
    sys.stdout.write(" ".join(map(str, (made.reference, made.deformed, *made.bounds))) + "\n")


if __name__ == "__main__":
    main()
