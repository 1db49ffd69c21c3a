"""Translation of the whole mesh to whole pixels, by normalised cross-correlation (with FFTs)."""

from itertools import product

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.errors import SolveError
from fedic.starts.candidate import Candidate, nodal_displacement, refined_candidate
from fedic.starts.images import StartImages
from fedic.starts.motion import translation
from fedic.starts.periodicity import other_maxima
from fedic.starts.template import correlation_map

__all__ = ["initial_translation", "rigid_translation", "translations"]

_COARSE_SIDE = 1024
_SMALLEST_WINDOW = 8
_WINDOWS, _WINDOW_SHARE = 3, 0.3
"""Number of windows of `rigid_translation` along each side of the image, and their size relative to the side."""


def initial_translation(reference: Image, deformed: Image, mesh: Mesh, camera: Camera) -> Floats:
    """Find the translation of the mesh's bounding window between two images, to whole pixels.

    The window is searched for in the whole deformed image, at a coarse scale if the images are large, then refined.

    Parameters
    ----------
    reference, deformed : ndarray, shape (height, width)
        The two images, of the same shape.
    mesh : Mesh
        Mesh; its used nodes, projected in the reference image, bound the window.
    camera : camera
        Camera that converts the shift in pixels to the displacement of each node, in the plane of the mean ``z``.

    Returns
    -------
    ndarray of float, shape (n, 2)
        Nodal displacements in the mesh's unit; zero at nodes of no cell.

    Raises
    ------
    SolveError
        If the window is too small, or has no texture.
    """
    pixels = camera.project(mesh.points[mesh.used_nodes])
    shift, _ = _window_shift(reference, deformed, pixels)
    return nodal_displacement(np.tile(shift.astype(np.float64), (mesh.num_nodes, 1)), mesh, camera)


def translations(images: StartImages) -> list[Candidate]:
    """Find the translation of the mesh's bounding window on reduced images, and refine it to an affine map.

    Parameters
    ----------
    images : StartImages
        The two images and the region of the mesh.

    Returns
    -------
    list of Candidate
        One candidate named ``"fft"``, with the other translations that match nearly as well; or none.
    """
    if not images.has_texture():
        return []
    level = images.level_of_side(_COARSE_SIDE)
    try:
        scores, shift = _shifts(level.reference, level.deformed, np.array(level.bounds(), dtype=np.float64))
    except SolveError:
        return []
    scale = np.diag(level.reduction)[:2]
    others = shift + other_maxima(scores)
    found = refined_candidate(images, "fft", translation(shift / scale), others / scale)
    return [] if found is None else [found]


def rigid_translation(reference: Image, moved: Image, mesh: Mesh, camera: Camera) -> Floats:
    """Find the translation of a rigid specimen between two images, to whole pixels.

    Windows of a third of the image's sides, distributed over the mesh, are searched for in the moved image, and the
    best match is returned, so that only a part of the specimen needs to stay in view.

    Parameters
    ----------
    reference, moved : ndarray, shape (height, width)
        The two images, of the same shape.
    mesh : Mesh
        Mesh of the specimen.
    camera : camera
        Camera that converts the shift in pixels to a translation in the plane of the mean ``z``.

    Returns
    -------
    ndarray of float, shape (2,)
        Translation along ``X`` and ``Y``, in the mesh's unit.

    Raises
    ------
    SolveError
        If the mesh covers too little of the image, or has no texture.
    """
    points = mesh.points[mesh.used_nodes]
    limits = np.array([reference.shape[1], reference.shape[0]], dtype=np.float64)
    pixels = camera.project(points)
    low, high = np.clip(pixels.min(axis=0), 0.0, limits), np.clip(pixels.max(axis=0), 0.0, limits)
    size = np.minimum(high - low, np.maximum(_WINDOW_SHARE * limits, 2.0 * _SMALLEST_WINDOW))
    found = []
    for along_u, along_v in product(np.linspace(0.0, 1.0, _WINDOWS), repeat=2):
        corner = low + (along_u, along_v) * (high - low - size)
        shift, score = _window_shift(reference, moved, np.array([corner, corner + size - 1.0]))
        found.append((score, corner + 0.5 * size, shift))
    _, centre, shift = max(found, key=lambda each: each[0])
    z = float(points[:, 2].mean()) if points.shape[1] == 3 else 0.0
    here, there = camera.unproject(np.array([centre, centre + shift]), z)[:, :2]
    motion: Floats = there - here
    return motion


def _window_shift(reference: Image, deformed: Image, pixels: Floats) -> tuple[NDArray[np.int64], float]:
    """Return the shift (u, v) of the window around `pixels`, and its correlation coefficient."""
    import cv2

    f, g = reference.astype(np.float32), deformed.astype(np.float32)
    height, width = f.shape
    step = max(height, width) / _COARSE_SIDE
    if step <= 1.0:
        return _best_shift(f, g, pixels)
    size = (round(width / step), round(height / step))
    coarse_f, coarse_g = (
        np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.float32) for image in (f, g)
    )
    guess = np.rint(_best_shift(coarse_f, coarse_g, pixels / step)[0] * step).astype(np.int64)
    return _best_shift(f, g, pixels, near=guess, reach=int(np.ceil(step)) + 2)


def _best_shift(
    f: NDArray[np.float32],
    g: NDArray[np.float32],
    pixels: Floats,
    near: NDArray[np.int64] | None = None,
    reach: int = 0,
) -> tuple[NDArray[np.int64], float]:
    """Return the shift (u, v) of the window around `pixels` and its score; `near` and `reach` limit the search."""
    scores, shift = _shifts(f, g, pixels, near, reach)
    return shift, float(scores.max())


def _shifts(
    f: NDArray[np.float32],
    g: NDArray[np.float32],
    pixels: Floats,
    near: NDArray[np.int64] | None = None,
    reach: int = 0,
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Return the scores of all shifts of the window around `pixels`, and the shift (u, v) of the largest."""
    height, width = f.shape
    low, high = _window(pixels, width, height)
    window = f[low[1] : high[1], low[0] : high[0]]
    if float(window.std()) == 0.0:
        raise SolveError('initial="fft": the reference image has no texture under the mesh; check mesh and camera.')
    first, last = np.zeros(2, dtype=np.int64), np.array([width, height])
    if near is not None:
        first = np.maximum(low + near - reach, 0)
        last = np.minimum(high + near + reach, last)
    scores = correlation_map(g[first[1] : last[1], first[0] : last[0]], window)
    v, u = np.unravel_index(int(np.argmax(scores)), scores.shape)
    shift: NDArray[np.int64] = first + np.array([u, v]) - low
    return scores, shift


def _window(pixels: Floats, width: int, height: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the bounds of the pixels, reduced to at most half the image so that the window can be shifted in it."""
    limits = np.array([width, height])
    low = np.clip(np.floor(pixels.min(axis=0)), 0, limits).astype(np.int64)
    high = np.clip(np.ceil(pixels.max(axis=0)) + 1, 0, limits).astype(np.int64)
    surplus = np.maximum((high - low) - limits // 2, 0)
    low, high = low + surplus // 2, high - (surplus - surplus // 2)
    if (high - low < _SMALLEST_WINDOW).any():
        raise SolveError(
            f'initial="fft": the mesh covers only {high[0] - low[0]} x {high[1] - low[1]} px of the image; '
            f'at least {_SMALLEST_WINDOW} px each way are needed: use initial="pyramid" or check the camera.'
        )
    return low, high
