"""Fit of features from the given start and, where that is poor, from the mesh turned by half a turn or mirrored.

A mesh that lies the wrong way round often fits its edges to a pixel or two, with a wrong scale; the fit from the turned
start is then better. No pose mirrors a mesh, so that fit is only reported.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.errors import FedicError, ImageError, SolveError
from fedic.registration._edges import measure_edge
from fedic.registration._features import BoundaryFeature, boundary_features
from fedic.registration._mirrored import mirrored_feature, mirrored_mesh, turned_camera
from fedic.registration._problem import Estimate, Group, Problem
from fedic.registration._steps import from_features
from fedic.registration._strips import feature_strips

__all__ = ["best_orientation"]

_FAIR_PX, _POOR_PX = 0.6, 1.0
"""Median distances of the worst feature from which on the mesh is tried turned, and also mirrored."""
_FAR_PX = 3.0
"""Largest distance that counts, and that of a segment without an edge."""
_BETTER = 0.7
"""Ratio of the distances below which another orientation fits better."""
_SEEN = 0.8
"""Fraction of the segments of a hole that must show an edge for the hole to count although it is not fitted."""
_REACHES_PX, _BAND_PX = (12.0, 3.0), 8.0
_TURNED_PARAMETERS = ({"u0", "v0", "angle"}, {"rz", "tx", "ty"})

_TURNED = (
    "The features fit better with the mesh turned by 180 degrees from the given start; that pose is returned. Check in "
    "the picture that the mesh lies as the specimen does."
)
_MIRRORED = (
    "The features fit better with the mesh mirrored: the mesh is drawn as seen from the other side of the specimen, or "
    "the image is mirrored. Mirror one of them."
)

Fit: TypeAlias = tuple[Estimate, list[Group], Problem]


@dataclass(frozen=True, eq=False)
class _Shape:
    """A mesh, the features that are fitted, and the holes that are not."""

    mesh: Mesh
    wanted: Sequence[BoundaryFeature]
    holes: Sequence[BoundaryFeature]

    def fit(self, start: Estimate, problem: Problem, search: float) -> Fit:
        return from_features(self.mesh, self.wanted, start, problem, search)

    def try_fit(self, start: Estimate, problem: Problem, search: float) -> Fit | None:
        try:
            return self.fit(start, problem, search)
        except FedicError:
            return None

    def mirrored(self, axis: int) -> "_Shape":
        wanted, holes = (
            [mirrored_feature(feature, self.mesh, axis) for feature in features]
            for features in (self.wanted, self.holes)
        )
        return _Shape(mirrored_mesh(self.mesh, axis), wanted, holes)

    def distances(self, fit: Fit) -> Floats:
        """Return the median distance of each feature and hole; NaN for a hole that shows no edge."""
        estimate, groups, problem = fit
        found = [_distance(group.residuals, group.used) for group in groups[: len(self.wanted)]]
        for hole in self.holes:
            try:
                (strip,) = feature_strips(self.mesh, [hole], problem.image, estimate.camera, 0.0)
            except FedicError:
                found.append(np.nan)
                continue
            for reach in _REACHES_PX:
                edge = measure_edge(problem.image, estimate.camera, strip, problem.names, reach, _BAND_PX)
                distance = _distance(edge.distances, edge.valid) if edge.valid.mean() >= _SEEN else np.nan
                if not distance < _FAR_PX:
                    break
            found.append(distance)
        return np.array(found)


def best_orientation(
    mesh: Mesh, wanted: Sequence[BoundaryFeature], start: Estimate, problem: Problem, search: float
) -> tuple[Estimate, list[Group], Problem, str]:
    """Fit features; if that is poor and no point tells the orientation, also with the mesh turned and mirrored.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    wanted : sequence of BoundaryFeature
        The features.
    start : Estimate
        The rough start.
    problem : Problem
        The problem without features.
    search : float
        Search distance in pixels.

    Returns
    -------
    Estimate, list of Group, Problem
        As `fedic.registration._steps.from_features`; from the turned start if that fits clearly better.
    str
        What there is to say about the orientation of the mesh, or nothing.

    Raises
    ------
    CameraError, ImageError, SolveError
        If there is no fit: the error from the given start.
    """
    shape = _Shape(mesh, wanted, _other_holes(mesh, wanted))
    given: Fit | None = None
    try:
        given = shape.fit(start, problem, search)
        ours = shape.distances(given)
    except (ImageError, SolveError) as error:
        fault = error
        ours = np.array([_POOR_PX / _BETTER])
    oriented = bool(problem.pairs) or start.place is not None
    if not oriented and not ours.max() <= _FAIR_PX and any(names <= {*problem.names} for names in _TURNED_PARAMETERS):
        turned = shape.try_fit(Estimate(turned_camera(start.camera, mesh)), problem, search)
        if turned is not None and _is_better(shape.distances(turned), ours):
            return *turned, _TURNED
    if not oriented and np.nanmax(ours) > _POOR_PX:
        for image in (shape.mirrored(axis) for axis in (0, 1)):
            mirrored = image.try_fit(start, problem, search)
            if mirrored is not None and _is_better(image.distances(mirrored), ours):
                if given is not None:
                    return *given, _MIRRORED
                fault = type(fault)(f"{fault} {_MIRRORED}")
                break
    if given is None:
        raise fault
    return *given, ""


def _other_holes(mesh: Mesh, wanted: Sequence[BoundaryFeature]) -> list[BoundaryFeature]:
    names = [feature.name for feature in wanted]
    holes = [feature for feature in boundary_features(mesh) if feature.name.startswith("hole ")]
    return [hole for hole in holes if hole.kind in ("circle", "loop") and hole.name not in names]


def _distance(distances: Floats, used: NDArray[np.bool_]) -> float:
    return float(np.median(np.where(used, np.minimum(np.abs(distances), _FAR_PX), _FAR_PX)))


def _is_better(distances: Floats, others: Floats) -> bool:
    """Return whether the worst distance is clearly smaller than that of others; holes without an edge are left out."""
    distances, others = np.broadcast_arrays(distances, others)
    known = np.isfinite(distances) | np.isfinite(others)
    ours, theirs = (np.where(np.isfinite(each), each, _FAR_PX)[known] for each in (distances, others))
    return bool(ours.max() < _BETTER * theirs.max())
