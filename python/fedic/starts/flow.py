"""Displacement that varies over the mesh, by dense optical flow after the best motion of the whole mesh."""

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import Floats
from fedic.starts.candidate import Candidate, refined_candidate
from fedic.starts.images import StartImages
from fedic.starts.motion import affine, moved
from fedic.starts.window import Grey, Window, sampled

__all__ = ["dense_flow"]

_CONSISTENT_PX = 0.5
_SMALLEST_SHARE = 0.5
"""Share of the mesh where flow forwards and backwards must agree."""
_REACH = 4
"""The flow of a node is the median over the square of this many pixels each way around it."""
_STEP = 2
_TOLERANCE_PX = 3.0
_SAMPLES = 2000
_NODES_AT_ONCE = 50_000


def dense_flow(images: StartImages, motion: Floats | None = None) -> list[Candidate]:
    """Find a displacement that varies over the mesh by dense inverse search (DIS optical flow).

    The deformed image is taken back by `motion`, and the flow is found that is left. An affine map is fitted to it and
    refined; if that makes the images agree better, the flow is found again after this map.

    Parameters
    ----------
    images : StartImages
        The two images and the region of the mesh.
    motion : ndarray of float64, shape (3, 3), optional
        The best motion known so far, in pixels; by default the identity.

    Returns
    -------
    list of Candidate
        One candidate named ``"flow"``; or none if the flows between the images in the two directions are not inverse to
        each other in half of the mesh.
    """
    if not images.has_texture():
        return []
    window = Window(images)
    base = np.eye(3) if motion is None else motion
    flow, trusted = _flow(window, base)
    fitted = _affine(window, flow, trusted)
    if fitted is not None:
        better = refined_candidate(images, "flow", base @ window.level.enlarged(fitted))
        if better is not None and better.score > max(window.match(base).score, window.match(base, flow).score):
            base = better.motion
            flow, trusted = _flow(window, base)
    if np.count_nonzero(trusted) < _SMALLEST_SHARE * np.count_nonzero(window.region):
        return []
    match = window.match(base, flow)
    if not match.is_significant:
        return []
    return [Candidate("flow", _at_nodes(images, window, base, flow, trusted), match.score, match.overlap, base)]


def _flow(window: Window, motion: Floats) -> tuple[Grey, NDArray[np.bool_]]:
    """Return the flow (h, w, 2) left after a motion, in pixels of the level, and where it can be trusted."""
    import cv2

    grey, weight = window.taken_back(window.level.reduced(motion))
    if not weight.any():
        return np.zeros((*weight.shape, 2), dtype=np.float32), weight > 0.0
    f, g = (
        np.asarray(np.clip(np.rint(128.0 + 50.0 * image * weight), 0, 255), dtype=np.uint8)
        for image in window.normalised(grey, weight)
    )
    search = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    forwards = np.asarray(search.calc(f, g, np.zeros((*f.shape, 2), dtype=np.float32)), dtype=np.float32)
    backwards = np.asarray(search.calc(g, f, np.zeros((*f.shape, 2), dtype=np.float32)), dtype=np.float32)
    height, width = weight.shape
    places = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(np.float32) + forwards
    error = np.linalg.norm(forwards + sampled(backwards, places), axis=-1)
    return forwards, (weight > 0.0) & (error <= _CONSISTENT_PX)


def _affine(window: Window, flow: Grey, trusted: NDArray[np.bool_]) -> Floats | None:
    """Return the affine map, shape (3, 3), in pixels of the level, that most of the trusted flow agrees with."""
    import cv2

    rows, columns = np.nonzero(trusted)
    step = max(1, len(rows) // _SAMPLES)
    rows, columns = rows[::step], columns[::step]
    if len(rows) < 3:
        return None
    here = np.stack([columns, rows], axis=-1) + window.low
    there = here + flow[rows, columns]
    cv2.setRNGSeed(0)
    found, _ = cv2.estimateAffine2D(here, there, method=cv2.RANSAC, ransacReprojThreshold=_TOLERANCE_PX)
    return None if found is None else affine(np.asarray(found, dtype=np.float64))


def _at_nodes(images: StartImages, window: Window, motion: Floats, flow: Grey, trusted: NDArray[np.bool_]) -> Floats:
    """Return the displacement of the nodes in pixels: the median of the trusted flow around each, then the motion."""
    displacement = np.zeros_like(images.nodes)
    height, width = trusted.shape
    offsets = np.arange(-_REACH, _REACH + 1, _STEP)
    placed = np.flatnonzero(np.isfinite(images.nodes).all(axis=1))
    for first in range(0, len(placed), _NODES_AT_ONCE):
        chosen = placed[first : first + _NODES_AT_ONCE]
        nodes = moved(window.level.reduction, images.nodes[chosen])
        columns, rows = np.rint(nodes - window.low).astype(np.int64).T
        rows = np.clip(rows[:, np.newaxis, np.newaxis] + offsets[:, np.newaxis], 0, height - 1)
        columns = np.clip(columns[:, np.newaxis, np.newaxis] + offsets, 0, width - 1)
        values = np.where(trusted[rows, columns][..., np.newaxis], flow[rows, columns], np.nan)
        values = values.reshape(len(chosen), -1, 2)
        known = np.isfinite(values[..., 0]).any(axis=1)
        shifts: Floats = np.zeros((len(chosen), 2))
        shifts[known] = np.nanmedian(values[known], axis=1)
        here: Floats = images.nodes[chosen] + shifts / np.diag(window.level.reduction)[:2]
        displacement[chosen] = moved(motion, here) - images.nodes[chosen]
    return displacement
