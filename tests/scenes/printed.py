"""Printed targets as bitmaps, and their views: perspective, a lens, noise, uneven light, clutter behind the target."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from fedic.calibration import Target

WIDTH, HEIGHT = 480, 360
_FOCAL = 525.0
_FINE = 2
_STEP = 40

Grey = NDArray[np.uint8]


@dataclass(frozen=True)
class Scene:
    """A target, four views of it, and the generator that made them.

    Attributes
    ----------
    target : Target
        The target that is printed.
    views : list of ndarray, shape (360, 480)
        Its views.
    rng : numpy.random.Generator
        For further draws.
    """

    target: Target
    views: list[Grey]
    rng: np.random.Generator


def scene(seed: int, views: int = 4) -> Scene:
    """Draw a target and its views: chessboard, circles and asymmetric circles in turn."""
    rng = np.random.default_rng(seed)
    kind = ("chessboard", "circles", "asymmetric-circles")[seed % 3]
    low, high = ((3, 7), (6, 12)) if kind == "asymmetric-circles" else ((5, 4), (11, 9))
    columns, rows = (int(count) for count in rng.integers(low, high))
    target = Target(kind, columns, rows, 10.0)  # type: ignore[arg-type]
    paper = printed(target, rng, squares=bool(rng.random() < 0.4))
    noise, radial = rng.uniform(0.0, 6.0), rng.uniform(-0.2, 0.2)
    cluttered, aside = rng.random(2) < 0.5
    seen = [view(paper, rng, noise=noise, radial=radial, cluttered=cluttered, aside=aside) for _ in range(views)]
    return Scene(target, seen, rng)


def printed(target: Target, rng: np.random.Generator, *, squares: bool = False) -> Grey:
    """Return the bitmap of a target, with a margin of two steps that may hold a frame of squares."""
    margin = 2 * _STEP
    paper, ink = int(rng.integers(200, 250)), 25
    if target.kind == "chessboard":
        first = int(rng.integers(2))
        cells = np.indices((target.rows + 1, target.columns + 1)).sum(axis=0) % 2 == first
        levels = np.where(cells, ink, paper).astype(np.uint8)
        bitmap = np.pad(np.kron(levels, np.ones((_STEP, _STEP), np.uint8)), margin, constant_values=paper)
    else:
        if rng.random() < 0.3:
            paper, ink = ink, paper
        places = target.points[:, :2] / target.pitches
        width, height = (_STEP * (places.max(axis=0) + 1)).astype(int) + 2 * margin
        bitmap = np.full((height, width), paper, np.uint8)
        radius = rng.uniform(0.22, 0.38) * _STEP * (1.0 if target.kind == "circles" else 1.25)
        for x, y in (places + 0.5) * _STEP + margin:
            centre = int(16 * x), int(16 * (height - y))
            cv2.circle(bitmap, centre, int(16 * radius), ink, -1, cv2.LINE_AA, 4)
    if squares:
        side, gap = int(_STEP * rng.uniform(0.4, 0.9)), _STEP // 8
        height, width = bitmap.shape
        for start in range(0, width - side, _STEP):
            for row in (gap, height - side - gap):
                bitmap[row : row + side, start : start + side] = ink
        for start in range(0, height - side, _STEP):
            for column in (gap, width - side - gap):
                bitmap[start : start + side, column : column + side] = ink
    return bitmap


def view(
    paper: Grey,
    rng: np.random.Generator,
    *,
    noise: float = 1.0,
    radial: float = 0.0,
    cluttered: bool = False,
    aside: bool = False,
) -> Grey:
    """Return a view of a bitmap, tilted by up to 34 degrees; `aside` moves it towards the border of the image."""
    height, width = paper.shape
    size = np.array([WIDTH, HEIGHT]) * _FINE
    focal = _FOCAL * _FINE
    tilt, azimuth, turn = rng.uniform(0.1, 0.6), rng.uniform(0.0, 2.0 * np.pi), rng.uniform(-0.5, 0.5)
    lean = cv2.Rodrigues(tilt * np.array([np.cos(azimuth), np.sin(azimuth), 0.0]))[0]
    rotation = lean @ cv2.Rodrigues(np.array([0.0, 0.0, turn]))[0]
    distance = focal * max(width / size[0], height / size[1]) * rng.uniform(1.1, 1.5)
    offset = np.append(0.22 * rng.uniform(-1.0, 1.0, 2) * size * distance / focal if aside else np.zeros(2), distance)
    rows, columns = np.indices((size[1], size[0]), dtype=np.float64)
    rays = np.stack([(columns - 0.5 * size[0]) / focal, (rows - 0.5 * size[1]) / focal, np.ones_like(rows)], axis=-1)
    rays[..., :2] *= 1.0 - radial * (rays[..., :2] ** 2).sum(axis=-1, keepdims=True)
    normal = rotation[:, 2]
    plane = rays * ((normal @ offset) / (rays @ normal))[..., np.newaxis] - offset
    x, y = plane @ rotation[:, 0] + 0.5 * width, plane @ rotation[:, 1] + 0.5 * height
    on_paper = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    seen = cv2.remap(paper, x.astype(np.float32), y.astype(np.float32), cv2.INTER_LINEAR)
    ground = _clutter(rng, size) if cluttered else np.full(seen.shape, rng.integers(60, 200), np.uint8)
    light = 1.0 + rng.uniform(-0.3, 0.3) * (columns / size[0] - 0.5) + rng.uniform(-0.3, 0.3) * (rows / size[1] - 0.5)
    blurred = cv2.GaussianBlur(0.9 * light * np.where(on_paper, seen, ground), (0, 0), 1.2)
    small = cv2.resize(blurred, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    return np.clip(np.rint(small + rng.normal(0.0, noise, small.shape)), 0, 255).astype(np.uint8)


def _clutter(rng: np.random.Generator, size: NDArray[np.int64]) -> Grey:
    ground = np.full((size[1], size[0]), rng.integers(60, 200), np.uint8)
    for _ in range(60):
        (x, y), level = (int(value) for value in rng.integers(0, size)), int(rng.integers(0, 255))
        kind = rng.integers(3)
        if kind == 0:
            cv2.circle(ground, (x, y), int(rng.integers(6, 30)), level, -1)
        elif kind == 1:
            width, height = (int(value) for value in rng.integers(10, 80, 2))
            cv2.rectangle(ground, (x, y), (x + width, y + height), level, -1)
        else:
            ends = tuple(int(value) for value in rng.integers(0, size))
            cv2.line(ground, (x, y), ends, level, 3)  # type: ignore[arg-type]
    return ground


def wrong_counts(target: Target, rng: np.random.Generator) -> Target:
    """Return the target with other counts: mostly up to two lines fewer in each direction, sometimes more."""
    fewer = rng.integers(0, np.minimum(3, np.array([target.columns, target.rows]) - 2))
    change = fewer if rng.random() < 0.2 else -fewer
    columns, rows = int(target.columns + change[0]), int(target.rows + change[1])
    if sorted((columns, rows)) == sorted((target.columns, target.rows)):
        columns -= 1
        if (columns, rows) == (target.rows, target.columns):
            rows -= 1
    return Target(target.kind, columns, rows, target.pitch)
