"""Meshes and starts with another orientation: turned by half a turn about the centre of the mesh, or mirrored."""

from dataclasses import replace

import numpy as np

from fedic._core import FrontParallel, Mesh
from fedic._internal.types import Floats
from fedic.cameras.poses import with_pose
from fedic.registration._features import BoundaryFeature
from fedic.registration._pieces import Circle, Piece
from fedic.registration._pose import Placeable

__all__ = ["mirrored_feature", "mirrored_mesh", "turned_camera"]


def turned_camera(camera: Placeable, mesh: Mesh) -> Placeable:
    """Return the camera that sees each point of the mesh where the point opposite to it was seen."""
    doubled = 2.0 * _centre(mesh)
    if isinstance(camera, FrontParallel):
        ((u, v),) = camera.project(doubled[np.newaxis])
        return FrontParallel(camera.scale, (float(u), float(v)), camera.angle + np.pi)
    turned = camera.rotation @ np.diag([-1.0, -1.0, 1.0])
    return with_pose(camera, turned, np.asarray(camera.translation) + camera.rotation @ [*doubled, 0.0])


def mirrored_mesh(mesh: Mesh, axis: int) -> Mesh:
    """Return the mesh mirrored about its centre: 0 swaps left and right, 1 bottom and top."""
    points = mesh.points.copy()
    points[:, axis] = 2.0 * _centre(mesh)[axis] - points[:, axis]
    return Mesh(points, mesh.cells)


def mirrored_feature(feature: BoundaryFeature, mesh: Mesh, axis: int) -> BoundaryFeature:
    """Return a feature of the mesh as a feature of the mirrored mesh, the material again on the left."""
    pieces = []
    for piece in feature.pieces[::-1]:
        circle = piece.circle
        if circle is not None:
            centre: Floats = circle.centre.copy()
            centre[axis] = 2.0 * _centre(mesh)[axis] - centre[axis]
            circle = Circle(centre, circle.radius)
        pieces.append(Piece(np.ascontiguousarray(piece.segments[::-1, ::-1]), circle, piece.closed))
    return replace(feature, nodes=feature.nodes[::-1], pieces=tuple(pieces))


def _centre(mesh: Mesh) -> Floats:
    """Return the centre of the bounding box of the nodes, shape (2,)."""
    used = mesh.points[mesh.used_nodes, :2]
    centre: Floats = 0.5 * (used.min(axis=0) + used.max(axis=0))
    return centre
