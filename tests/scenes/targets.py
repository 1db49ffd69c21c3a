"""Calibration targets as textures, and views of them through a known camera."""

import cv2
import numpy as np
from numpy.typing import NDArray

import fedic
from fedic.calibration import Target

SHAPE = (480, 640)
FOCAL, CENTRE = (900.0, 905.0), (325.0, 236.0)
BLUR = 0.1
"""Standard deviation of the blurred edges, in mesh units; half a pixel."""


def pinhole(
    rotation: NDArray[np.float64], translation: NDArray[np.float64], lens: fedic.BrownDistortion
) -> fedic.Pinhole:
    return fedic.Pinhole(FOCAL, CENTRE, rotation, tuple(translation), distortion=lens)


def poses(target: Target, count: int, lens: fedic.BrownDistortion) -> list[fedic.Pinhole]:
    """Return cameras that see the whole target as large as possible, tilted about all axes, all over the image."""
    rng = np.random.default_rng(0)
    if target.kind == "charuco":
        low, high = np.zeros(2), np.array([target.columns, target.rows]) * target.pitches[0]
    else:
        low, high = target.points.min(axis=0)[:2] - target.pitches[0], target.points.max(axis=0)[:2] + target.pitches[0]
    box = np.array([[x, y, 0.0] for x in (low[0], high[0]) for y in (low[1], high[1])])
    room = np.array(SHAPE[::-1]) - 9.0
    cameras = []
    for view in range(count):
        azimuth = 6.0 * np.pi * view / count + rng.uniform(-0.3, 0.3)
        tilt = rng.uniform(0.25, 0.6) * np.array([np.cos(azimuth), np.sin(azimuth), 0.0]) * (view > 0)
        turn = np.array([0.0, 0.0, rng.uniform(-0.15, 0.15)])
        rotation = cv2.Rodrigues(tilt)[0] @ cv2.Rodrigues(turn)[0] @ np.diag([1.0, -1.0, -1.0])
        side = rng.integers(0, 2, size=2)
        translation = np.array([0.0, 0.0, 2.0 * FOCAL[0] * np.ptp(box) / SHAPE[1]]) - rotation @ box.mean(axis=0)
        for _ in range(30):
            seen = pinhole(rotation, translation, lens).project(box)
            extent = np.ptp(seen, axis=0)
            distance = (rotation @ box.mean(axis=0) + translation)[2]
            translation[2] += distance * ((extent / room).max() - 1.0)
            wanted = 4.0 + (room - extent) * side
            translation[:2] += 0.8 * distance / FOCAL[0] * (wanted - seen.min(axis=0))
        cameras.append(pinhole(rotation, translation, lens))
    return cameras


class Texture:
    """Texture of a target: ink 0, paper 1, blurred edges."""

    def __init__(self, target: Target) -> None:
        self._target = target
        if target.kind == "charuco":
            dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, target.dictionary))
            size = (target.columns, target.rows)
            board = cv2.aruco.CharucoBoard(size, target.pitches[0], target.marker, dictionary)
            self._scale = 40
            bitmap = board.generateImage((size[0] * self._scale, size[1] * self._scale), marginSize=0) / 255.0
            padded = np.pad(bitmap, self._scale, constant_values=1.0)
            self._bitmap = cv2.GaussianBlur(padded, (0, 0), BLUR * self._scale / target.pitches[0])

    def values(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y = np.asarray(points)[:, 0], np.asarray(points)[:, 1]
        if self._target.kind == "chessboard":
            return self._chessboard(x, y)
        if self._target.kind == "ring-dots":
            return self._ring_dots(x, y)
        return self._board(x, y) if self._target.kind == "charuco" else self._circles(x, y)

    def _chessboard(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        pitch = self._target.pitches[0]
        product, inside = np.ones_like(x), np.ones_like(x)
        for along, count in ((x, self._target.columns), (y, self._target.rows)):
            edge = np.clip(np.round(along / pitch), 0, count - 1)
            product *= np.where(edge % 2 == 0, 1.0, -1.0) * _edge(along - edge * pitch)
            inside *= 0.25 * (1.0 + _edge(along + pitch)) * (1.0 - _edge(along - count * pitch))
        return 1.0 - 0.5 * inside * (1.0 + product)

    def _circles(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        target = self._target
        row = np.clip(np.round(y / target.pitches[0]), 0, target.rows - 1)
        if target.kind == "circles":
            column = np.clip(np.round(x / target.pitches[0]), 0, target.columns - 1)
            distance = np.hypot(x - column * target.pitches[0], y - row * target.pitches[0])
            return 0.5 * (1.0 + _edge(distance - 0.3 * target.pitches[0]))
        distance = np.full_like(x, np.inf)
        for near in (np.floor(y / target.pitches[0]), np.floor(y / target.pitches[0]) + 1):
            row = np.clip(near, 0, target.rows - 1)
            shift = (target.rows - 1 - row) % 2
            column = np.clip(np.round((x / target.pitches[0] - shift) / 2), 0, target.columns - 1)
            along = x - (2 * column + shift) * target.pitches[0]
            distance = np.minimum(distance, np.hypot(along, y - row * target.pitches[0]))
        return 0.5 * (1.0 + _edge(distance - 0.4 * target.pitches[0]))

    def _ring_dots(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Dots of 0.3 pitch; the three rings are 0.38 pitch wide, with a hole of 0.19."""
        target = self._target
        pitch, (left, below), (along, up) = target.pitches[0], target.origin, target.axes
        column = np.clip(np.round(x / pitch), -left, target.columns - 1 - left)
        row = np.clip(np.round(y / pitch), -below, target.rows - 1 - below)
        distance = np.hypot(x - column * pitch, y - row * pitch)
        is_ring = np.zeros(len(x), dtype=bool)
        for place in ((0, 0), (along, 0), (0, up)):
            is_ring |= (column == place[0]) & (row == place[1])
        dot = 0.5 * (1.0 + _edge(distance - np.where(is_ring, 0.38, 0.3) * pitch))
        return np.where(is_ring, np.maximum(dot, 0.5 * (1.0 - _edge(distance - 0.19 * pitch))), dot)

    def _board(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        target, scale = self._target, self._scale
        column = x / target.pitches[0] * scale + scale - 0.5
        row = (target.rows - y / target.pitches[0]) * scale + scale - 0.5
        pieces = [
            cv2.remap(self._bitmap, u[:, None], v[:, None], cv2.INTER_LINEAR, borderValue=1.0)[:, 0]
            for u, v in zip(_pieces(column), _pieces(row), strict=True)
        ]
        return np.concatenate(pieces)


def _pieces(values: NDArray[np.float64]) -> list[NDArray[np.float32]]:
    """Split an array into pieces of a size that `cv2.remap` accepts."""
    return np.array_split(values.astype(np.float32), len(values) // 30_000 + 1)


def _edge(distance: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.tanh(1.2 * distance / (BLUR * np.sqrt(2.0)))
