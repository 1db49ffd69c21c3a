"""A speckled plane before and after an affine motion about the centre of the image."""

import numpy as np
from numpy.typing import NDArray

import fedic
from fedic.starts.motion import affine, moved

Pair = tuple[NDArray[np.uint8], NDArray[np.uint8]]


def motion(
    angle: float = 0.0, stretch: tuple[float, float] = (1.0, 1.0), shift: tuple[float, float] = (0.0, 0.0), *, side: int
) -> NDArray[np.float64]:
    """Return the matrix of a stretch along u and v, then a rotation in degrees about the centre, then a shift."""
    turn = np.radians(angle)
    linear = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) @ np.diag(stretch)
    centre = np.full(2, 0.5 * (side - 1))
    return affine(np.column_stack([linear, centre - linear @ centre + shift]))


class _Moved:
    def __init__(self, texture: fedic.synthetic.Speckle, matrix: NDArray[np.float64]) -> None:
        self._texture, self._back = texture, np.linalg.inv(matrix)

    def values(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        return self._texture.values(np.ascontiguousarray(moved(self._back, points)))


def pair(
    matrix: NDArray[np.float64], *, side: int, noise: float = 1.0, contrast: float = 1.0, size: float = 5.0
) -> Pair:
    """Render both images; the contrast is that of the second one relative to the first."""
    texture = fedic.synthetic.Speckle(size, seed=3)
    images = [
        fedic.synthetic.render(
            each,
            fedic.ImageFrame(),
            (side, side),
            noise=noise,
            seed=seed,
            supersampling=2,
            levels=(0.5 - 0.4 * share, 0.5 + 0.4 * share),
        )
        for seed, each, share in ((1, texture, 1.0), (2, _Moved(texture, matrix), contrast))
    ]
    return images[0], images[1]  # type: ignore[return-value]
