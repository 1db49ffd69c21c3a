"""Registration of the plate with a hole: cameras, mesh, and the errors of a pose."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

import fedic
from scenes.plate import LENGTH, WIDTH, Plate, plate_mesh

SHAPE = (400, 600)
LENS = fedic.BrownDistortion((-0.15, 0.05, 0.0), (1e-3, -5e-4))
TILTED = cv2.Rodrigues(np.array([0.12, -0.1, 0.05]))[0] @ np.diag([1.0, -1.0, -1.0])
FRONT = fedic.FrontParallel(8.0, (60.0, 270.0), 0.05)
PINHOLE = fedic.Pinhole(
    (900, 905), (300, 200), TILTED, tuple(np.array([0, 0, 100.0]) - TILTED @ [30.0, 12.5, 0.0]), distortion=LENS
)
CAMERAS = {"front": FRONT, "pinhole": PINHOLE}
BARE = fedic.Pinhole((900, 905), (300, 200), distortion=LENS)
MESH = plate_mesh()
BOUNDARY = ["hole 0", "left", "right", "bottom", "top"]
BLANK = np.zeros(SHAPE, np.uint8)
POINTS = np.array([[x, y] for x in (0.0, 20.0, 40.0, LENGTH) for y in (0.0, 9.0, WIDTH)])


def values(camera: Any) -> NDArray[np.float64]:
    return np.array([*camera.origin, camera.angle, camera.scale])


def errors(found: Any, true: Any) -> NDArray[np.float64]:
    """Return the errors of the parameters of a pose: of a pinhole as `rx ry rz tx ty tz`."""
    if isinstance(true, fedic.FrontParallel):
        return values(found) - values(true)
    turn = cv2.Rodrigues(found.rotation @ true.rotation.T)[0].ravel()
    return np.concatenate([turn, np.subtract(found.translation, true.translation)])


def off(found: Any, true: Any, mesh: fedic.Mesh = MESH) -> NDArray[np.float64]:
    """Return the distance of each projected node from its true position, in pixels."""
    return np.linalg.norm(found.project(mesh.points) - true.project(mesh.points), axis=1)


def plate(camera: Any, ground: float, seed: int = 0, **options: Any) -> NDArray[np.uint8]:
    return fedic.synthetic.render(Plate(ground, seed), camera, SHAPE, noise=2.0, seed=seed, **options)  # type: ignore[return-value]


BOARD = "chessboard:7x4:2"
