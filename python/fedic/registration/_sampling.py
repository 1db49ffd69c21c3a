"""Points along a boundary feature, about one per pixel, on its true shape.

A straight piece is sampled along its edges; a circle or an arc on the circle through its nodes, since the chords of a
linear mesh lie inside it; other edges of quadratic cells on their parabolas.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.errors import CameraError
from fedic.registration._features import BoundaryFeature
from fedic.registration._pieces import Circle, Piece
from fedic.registration._pose import Placeable
from fedic.registration._space import in_space

__all__ = ["Samples", "image_normals", "sample_feature"]

_FEWEST = 8
_TRIMMED_PX = 6.0
_TRIMMED_PART = 0.1


@dataclass(frozen=True, eq=False)
class Samples:
    """Points along a feature.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        Points in the frame of the mesh.
    normals : ndarray, shape (n, 3)
        Unit vectors out of the material, in the plane of the mesh.
    blocks : ndarray of int, shape (n,)
        Index of the segment of the edge that each point belongs to, from 0.
    """

    points: Floats
    normals: Floats
    blocks: NDArray[np.int64]


def sample_feature(mesh: Mesh, feature: BoundaryFeature, camera: Placeable, block_px: float) -> Samples:
    """Sample a feature about once per pixel; corners are left out.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    feature : BoundaryFeature
        One of its features.
    camera : FrontParallel or Pinhole
        Camera, for the size of a pixel.
    block_px : float
        Length of the segments in pixels.

    Returns
    -------
    Samples
        Samples of all pieces of the feature.

    Raises
    ------
    CameraError
        If the camera does not see the feature.
    """
    nodes = in_space(mesh.points)
    parts, first = [], 0
    for piece in feature.pieces:
        fine, _ = _shape(piece, nodes, np.linspace(0.0, 1.0, 200))
        length = float(np.linalg.norm(np.diff(camera.project(fine), axis=0), axis=1).sum())
        if not np.isfinite(length):
            raise CameraError(f"camera: the given pose does not see all of the feature {feature.name!r}; correct it.")
        trim = 0.0 if piece.closed else min(_TRIMMED_PX / max(length, 1e-9), _TRIMMED_PART)
        count = max(_FEWEST, round(length * (1.0 - 2.0 * trim)))
        place = trim + (1.0 - 2.0 * trim) * (np.arange(count) + 0.5) / count
        points, tangents = _shape(piece, nodes, place)
        normals = np.column_stack([tangents[:, 1], -tangents[:, 0], np.zeros(count)])
        number = max(1, round(count / block_px))
        parts.append(Samples(points, normals, first + np.arange(count) * number // count))
        first += number
    return Samples(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.blocks for part in parts]),
    )


def image_normals(camera: Placeable, samples: Samples) -> Floats:
    """Return unit vectors (n, 2) across the projected feature, out of the material."""
    slopes = camera.jacobian(samples.points)
    tangents = np.column_stack([-samples.normals[:, 1], samples.normals[:, 0], np.zeros(len(samples.points))])
    along = np.einsum("nij,nj->ni", slopes, tangents)
    across = np.column_stack([along[:, 1], -along[:, 0]])
    outwards = np.einsum("nij,nj->ni", slopes, samples.normals)
    across *= np.where((across * outwards).sum(axis=1) < 0.0, -1.0, 1.0)[:, np.newaxis]
    lengths: Floats = np.linalg.norm(across, axis=1, keepdims=True)
    normals: Floats = across / lengths
    return normals


def _shape(piece: Piece, nodes: Floats, place: Floats) -> tuple[Floats, Floats]:
    """Return points (n, 3) and unit tangents (n, 2) at fractions of the length of a piece."""
    segments = piece.segments
    ends = nodes[segments[:, 0]], nodes[segments[:, 2]]
    middles = np.where(segments[:, 1:2] >= 0, nodes[segments[:, 1]], 0.5 * (ends[0] + ends[1]))
    start = np.concatenate([[0.0], np.cumsum(np.linalg.norm(ends[1] - ends[0], axis=1))])
    along = place * start[-1]
    which = np.clip(np.searchsorted(start, along, side="right") - 1, 0, len(segments) - 1)
    s = ((along - start[which]) / (start[which + 1] - start[which]))[:, np.newaxis]
    a, m, b = ends[0][which], middles[which], ends[1][which]
    points = (1.0 - s) * (1.0 - 2.0 * s) * a + 4.0 * s * (1.0 - s) * m + s * (2.0 * s - 1.0) * b
    slopes = ((4.0 * s - 3.0) * a + (4.0 - 8.0 * s) * m + (4.0 * s - 1.0) * b)[:, :2]
    if piece.circle is not None:
        points, slopes = _on_circle(piece.circle, points, slopes)
    tangents: Floats = slopes / np.linalg.norm(slopes, axis=1, keepdims=True)
    return points, tangents


def _on_circle(circle: Circle, points: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    radii = points[:, :2] - circle.centre
    radii = radii * (circle.radius / np.linalg.norm(radii, axis=1, keepdims=True))
    tangents = np.column_stack([-radii[:, 1], radii[:, 0]])
    tangents *= np.where((tangents * slopes).sum(axis=1) < 0.0, -1.0, 1.0)[:, np.newaxis]
    return np.column_stack([circle.centre + radii, points[:, 2]]), tangents
