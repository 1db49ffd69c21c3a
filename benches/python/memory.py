"""Measure the memory of a large pair of images: python memory.py [--megapixels 150] [--element 20] [--help].

The reference image of 5 megapixels is repeated side by side up to the size wanted, which takes seconds where rendering
takes minutes, and moved by whole pixels for the deformed one: this measures memory, not accuracy. The peak is that of
the whole process, from files to files, with images left in their files as `fedic run` does.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
import tifffile
from compare import ELEMENT, FEDIC, HERE, launch
from make_pair import Pair, default_folder, make, pair

TILE = 5.0
"""Megapixels of the image that is repeated."""
SHIFT = (1, -2)
"""Rows and columns by which it is moved."""


def tiled(megapixels: float, tile: Pair, folder: Path) -> Pair:
    """Write a pair made of copies of the reference image of another one."""
    shape = pair(megapixels, folder).shape
    made = Pair(shape, folder / "reference.tif", folder / "deformed.tif")
    copies = [-(-side // own) for side, own in zip(shape, tile.shape, strict=True)]
    image = np.tile(tifffile.imread(tile.reference), copies)[: shape[0], : shape[1]]
    tifffile.imwrite(made.reference, image)
    tifffile.imwrite(made.deformed, np.roll(image, SHIFT, axis=(0, 1)))
    return made


def main() -> int:
    """Measure once for every size of the elements and print one line each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--megapixels", type=float, default=150.0)
    parser.add_argument("--element", type=int, nargs="+", default=[ELEMENT], help="sizes of the elements, in pixels")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--folder", type=Path, default=default_folder(), help="where the image repeated is kept")
    given = parser.parse_args()
    tile = pair(TILE, given.folder.resolve())
    make(tile)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        images = tiled(given.megapixels, tile, folder)
        height, width = images.shape
        for element in given.element:
            command = [sys.executable, HERE / FEDIC.script, images.reference, images.deformed, *images.bounds]
            found = launch([*command, element, given.threads, folder / "out"], given.threads, folder)
            if "failed" in found:
                sys.stderr.write(f"element {element} px: {found['failed']}\n")
                return 1
            said = found["said"]
            sys.stdout.write(
                f"{width} x {height} px, elements of {element} px: {said['points']:.0f} points, "
                f"{said['unknowns']:.0f} unknowns, {said['iterations']:.0f} iterations, "
                f"peak {found['peak_MB']:.0f} MB, {found['peak_MB'] * 1e6 / (width * height):.1f} bytes per pixel\n"
            )
            sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
