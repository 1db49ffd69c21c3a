"""A rough start brought near: the similarity of the projected features whose outline the image shows best.

The image is smoothed until speckles vanish. Across the outline of a specimen its grey level then changes, or the local
unrest that speckles leave, in the same direction all along a feature, which is what chance does not give. Translations,
turns and changes of scale of the projected features are tried on a grid, then on a finer one around the best.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._types import Floats, Image
from fedic.registration.edges import Strip
from fedic.registration.pose import Placeable, move, pose_jacobian, similarity_parameters
from fedic.registration.sampling import image_normals

__all__ = ["nearby"]

_POINTS_PER_FEATURE = 48
_TURN = np.deg2rad(4.0)
_GROWTH = 0.06
_GRIDS = ((6.0, 1.0), (3.0, 1.0 / 6.0))
"""Smoothing in pixels, and reach in parts of that asked for, of each grid; its step is 1.25 times the smoothing."""
_UNREST_PX = 2.0
_CHUNK = 2000

Complexes: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class _Outline:
    """Some points of the projected features, as complex numbers about their centre."""

    arms: list[Complexes]
    normals: list[Complexes]
    centre: complex


def nearby(
    image: Image, camera: Placeable, strips: Sequence[Strip], names: tuple[str, ...], search: float
) -> Placeable:
    """Move a camera to the best place in the neighbourhood.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The image.
    camera : FrontParallel or Pinhole
        The start.
    strips : sequence of Strip
        The features.
    names : tuple of str
        The free parameters; only those that move, turn and scale the image are changed.
    search : float
        Largest translation of the centre of the features, in pixels; turns go to 4 degrees and scales to 6 %.

    Returns
    -------
    FrontParallel or Pinhole
        Right to a few pixels if the specimen is where the search looks.
    """
    names = similarity_parameters(names)
    if not names or search <= 0.0:
        return camera
    outline = _outline(camera, strips)
    best = np.array([0.0 + 0.0j, 1.0 + 0.0j])
    for smoothing, part in _GRIDS:
        channels = _channels(image, smoothing)
        candidates = _candidates(outline, names, 1.25 * smoothing, part, search, best)
        scores = np.concatenate(
            [
                _scores(channels, outline, candidates[first : first + _CHUNK], 1.5 * smoothing)
                for first in range(0, len(candidates), _CHUNK)
            ]
        )
        best = candidates[int(np.argmax(scores))]
    return _moved(camera, strips, names, outline.centre, best)


def _outline(camera: Placeable, strips: Sequence[Strip]) -> _Outline:
    arms, normals = [], []
    for strip in strips:
        count = len(strip.samples.points)
        some = np.unique(np.linspace(0, count - 1, min(count, _POINTS_PER_FEATURE)).astype(int))
        arms.append(camera.project(strip.samples.points)[some] @ [1.0, 1.0j])
        normals.append(image_normals(camera, strip.samples)[some] @ [1.0, 1.0j])
    centre = complex(np.concatenate(arms).mean())
    return _Outline([each - centre for each in arms], normals, centre)


def _candidates(
    outline: _Outline, names: tuple[str, ...], step: float, part: float, search: float, about: Complexes
) -> Complexes:
    """Return similarities ``(t, f)``, complex (n, 2): the point ``a`` about the centre goes to ``t + f a``."""
    arm = float(np.abs(np.concatenate(outline.arms)).max())
    tries = {
        "u": search if {"u0", "tx"} & set(names) else 0.0,
        "v": search if {"v0", "ty"} & set(names) else 0.0,
        "turn": _TURN if {"angle", "rz"} & set(names) else 0.0,
        "growth": _GROWTH if {"scale", "tz"} & set(names) else 0.0,
    }
    axes = []
    for name, reach in tries.items():
        size = step if name in ("u", "v") else step / arm
        count = int(np.ceil(part * reach / size))
        axes.append(np.arange(-count, count + 1) * size)
    u, v, turn, growth = (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij"))
    return np.column_stack([about[0] + u + 1.0j * v, about[1] * (1.0 + growth) * np.exp(1.0j * turn)])


def _channels(image: Image, smoothing: float) -> list[Floats]:
    """Return the smoothed grey level and the smoothed unrest, each divided by its spread over the image."""
    import cv2

    grey = np.asarray(image, dtype=np.float32)
    unrest = np.abs(grey - cv2.GaussianBlur(grey, (0, 0), _UNREST_PX))
    channels = []
    for channel in (grey, unrest):
        smooth: Floats = np.asarray(cv2.GaussianBlur(channel, (0, 0), smoothing), dtype=np.float64)
        channels.append(smooth / max(float(smooth.std()), 1e-12))
    return channels


def _scores(channels: list[Floats], outline: _Outline, candidates: Complexes, offset: float) -> Floats:
    """Return for each candidate the mean changes across the features, summed without their signs."""
    height, width = channels[0].shape
    shift, factor = candidates[:, :1] + outline.centre, candidates[:, 1:]
    total = np.zeros(len(candidates))
    for arms, normals in zip(outline.arms, outline.normals, strict=True):
        places = shift + factor * arms
        across = offset * normals * (factor / np.abs(factor))
        inner, outer = (
            (np.rint(side.imag).astype(int), np.rint(side.real).astype(int))
            for side in (places - across, places + across)
        )
        seen = np.ones(places.shape, dtype=bool)
        for rows, columns in (inner, outer):
            seen &= (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
            np.clip(rows, 0, height - 1, out=rows)
            np.clip(columns, 0, width - 1, out=columns)
        for channel in channels:
            changes = np.where(seen, channel[inner] - channel[outer], 0.0)
            total += np.abs(changes.mean(axis=1))
    return total


def _moved(
    camera: Placeable, strips: Sequence[Strip], names: tuple[str, ...], centre: complex, similarity: Complexes
) -> Placeable:
    """Return the camera whose features are where a similarity takes them, as near as its parameters allow."""
    points = np.concatenate([strip.samples.points for strip in strips])
    places = camera.project(points) @ [1.0, 1.0j]
    wanted = centre + similarity[0] + similarity[1] * (places - centre)
    targets = np.column_stack([wanted.real, wanted.imag])
    for _ in range(4):
        rows = pose_jacobian(camera, points, names).reshape(-1, len(names))
        scale = np.linalg.norm(rows, axis=0)
        away = (targets - camera.project(points)).ravel()
        camera = move(camera, names, np.linalg.lstsq(rows / scale, away, rcond=1e-6)[0] / scale)
    return camera
