"""A speckled plate with a hole on a plain background: texture, mesh and wrong starting poses."""

import itertools

import numpy as np
from numpy.typing import NDArray

import fedic
from fedic.calibration import Target
from scenes.targets import Texture

LENGTH, WIDTH, RADIUS = 60.0, 25.0, 5.0
CENTRE = (33.0, 11.0)
EDGE = 0.06
"""Standard deviation of the blurred edges, in millimetres."""


class Plate:
    """Texture from 0 to 1: speckle on the plate, a constant level around it."""

    def __init__(self, ground: float, seed: int = 0, size: float = 0.4) -> None:
        self._speckle, self._ground = fedic.synthetic.Speckle(size), ground
        self._elsewhere = seed * np.array([137.3, 211.9])  # another part of the texture for each plate

    def values(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y = np.asarray(points)[:, 0], np.asarray(points)[:, 1]
        inside = np.minimum(np.minimum(x, LENGTH - x), np.minimum(y, WIDTH - y))
        inside = np.minimum(inside, np.hypot(x - CENTRE[0], y - CENTRE[1]) - RADIUS)
        covered = 0.5 * (1.0 + np.tanh(1.2 * inside / (EDGE * np.sqrt(2.0))))
        return self._ground + covered * (self._speckle.values(points[:, :2] + self._elsewhere) - self._ground)


def plate_mesh(cell: str = "quad", divisions: int = 16) -> fedic.Mesh:
    """Return a mesh of the plate: rings around the hole that become the rectangle."""
    count, rings = 4 * divisions, 5
    corners = np.array([[LENGTH, 0.0], [LENGTH, WIDTH], [0.0, WIDTH], [0.0, 0.0]])
    angle = np.arctan2(*(corners - CENTRE).T[::-1])
    angle = np.unwrap(np.append(angle, angle[0]))
    theta = np.concatenate([np.linspace(angle[k], angle[k + 1], divisions, endpoint=False) for k in range(4)])
    side = np.concatenate([np.linspace(corners[k], corners[(k + 1) % 4], divisions, endpoint=False) for k in range(4)])
    hole = np.array(CENTRE) + RADIUS * np.column_stack([np.cos(theta), np.sin(theta)])
    part = np.linspace(0.0, 1.0, rings + 1)[:, np.newaxis, np.newaxis]
    points = (hole + part * (side - hole)).reshape(-1, 2)
    ring, step = (index.ravel() for index in np.indices((rings, count)))
    following = (step + 1) % count
    quads = np.column_stack(
        [ring * count + step, (ring + 1) * count + step, (ring + 1) * count + following, ring * count + following]
    )
    if cell == "triangle":
        return fedic.Mesh(points, {"triangle": np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])})
    return fedic.Mesh(points, {"quad": quads})


def signs() -> list[tuple[int, ...]]:
    """Return all combinations of signs of the four errors of a starting pose."""
    return list(itertools.product((-1, 1), repeat=4))


def wrong(camera: fedic.FrontParallel | fedic.Pinhole, sign: tuple[int, ...]) -> fedic.FrontParallel | fedic.Pinhole:
    """Return a camera displaced by 15 px in both directions, rotated by 2 degrees and scaled by 3 %."""
    right, down, turn, growth = sign * np.array([15.0, 15.0, np.deg2rad(2.0), 0.03])
    if isinstance(camera, fedic.FrontParallel):
        u, v = camera.origin
        return fedic.FrontParallel(camera.scale * (1.0 + growth), (u + right, v + down), camera.angle + turn)
    cos, sin = np.cos(turn), np.sin(turn)
    rotation = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ camera.rotation
    tx, ty, tz = camera.translation
    pixel = tz / camera.focal[0]
    return fedic.Pinhole(
        camera.focal,
        camera.principal_point,
        rotation,
        (tx + right * pixel, ty + down * pixel, tz * (1.0 + growth)),
        distortion=camera.distortion,
    )


class WithTarget:
    """Texture of a plate with a printed target at a given origin and angle."""

    def __init__(self, plate: Plate, target: Target, origin: tuple[float, float], angle: float) -> None:
        self._plate, self._target, self._printed = plate, target, Texture(target)
        self._origin, self._angle = np.array(origin), angle

    def values(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        values = self._plate.values(points)
        cos, sin = np.cos(self._angle), np.sin(self._angle)
        local = (np.asarray(points)[:, :2] - self._origin) @ np.array([[cos, -sin], [sin, cos]])
        reach = 1.9 * self._target.pitches[0]
        high = np.array([self._target.columns - 1, self._target.rows - 1]) * self._target.pitches[0]
        on = np.all((local > -reach) & (local < high + reach), axis=1)
        values[on] = self._printed.values(np.ascontiguousarray(local[on]))
        return values
