"""Generate the test images in images/: speckle patterns from plain formulas, moved by an analytic displacement.

The images are stored, so that results do not depend on the platform's exponential function: run this script only to
change them, then run `make_fedic_results.py` and `make_peer_results.py`.
"""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

IMAGES = Path(__file__).parent / "images"
SHAPE = (160, 200)
FAR = np.array([13.0, -9.0])

Floats = NDArray[np.float64]


def displacement(points: Floats) -> Floats:
    """Return the displacement in pixels, shape (n, 2), at pixel positions (u, v), shape (n, 2)."""
    u, v = points.T
    along_u = 0.4 + 0.006 * (u - 100.0) - 0.003 * (v - 80.0) + 0.3 * np.sin(2.0 * np.pi * v / 90.0)
    along_v = -0.3 + 0.002 * (u - 100.0) - 0.004 * (v - 80.0) + 0.2 * np.cos(2.0 * np.pi * u / 110.0)
    return np.column_stack([along_u, along_v])


def speckle(points: Floats) -> Floats:
    """Return grey levels of Gaussian spots on a jittered grid, shape (n,)."""
    grid = np.stack(np.meshgrid(np.arange(-30.0, 235.0, 5.0), np.arange(-30.0, 195.0, 5.0)), axis=-1).reshape(-1, 2)
    random = np.random.default_rng(20261127)
    centres = grid + random.uniform(-2.5, 2.5, grid.shape)
    amplitudes = random.choice([-1.0, 1.0], len(grid)) * random.uniform(0.5, 1.0, len(grid))
    sizes = random.uniform(2.0, 2.8, len(grid))
    sums = np.zeros(len(points))
    for centre, amplitude, size in zip(centres, amplitudes, sizes, strict=True):
        sums += amplitude * np.exp(-0.5 * ((points - centre) ** 2).sum(axis=1) / size**2)
    return 128.0 + 95.0 * np.tanh(1.2 * sums)


def material(points: Floats, shift: Floats) -> Floats:
    """Return the reference positions of the material that `displacement` and `shift` move to `points`."""
    found = points - shift
    for _ in range(60):
        found = points - shift - displacement(found)
    return found


def quantized(levels: Floats) -> NDArray[np.uint8]:
    """Return grey levels as an 8-bit image."""
    return np.clip(np.round(levels), 0, 255).reshape(SHAPE).astype(np.uint8)


def main() -> None:
    """Write the images."""
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(float)
    pixels = np.column_stack([u.ravel(), v.ravel()])
    near, far = speckle(material(pixels, np.zeros(2))), speckle(material(pixels, FAR))
    light = 0.96 + 0.02 * np.sin(pixels[:, 0] / 60.0) * np.cos(pixels[:, 1] / 50.0)
    IMAGES.mkdir(exist_ok=True)
    for name, levels in {
        "reference": speckle(pixels),
        "deformed": near,
        "uneven_light": light * near + 2.0,
        "far": far,
    }.items():
        cv2.imwrite(str(IMAGES / f"{name}.png"), quantized(levels), [cv2.IMWRITE_PNG_COMPRESSION, 9])


if __name__ == "__main__":
    main()
