"""Steps of a registration: target, points, features, each checked before the next."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fedic._core import Mesh, Pinhole
from fedic._internal.types import Floats
from fedic.cameras.poses import with_pose
from fedic.errors import CameraError, ImageError, OptionError, SolveError
from fedic.registration._covariance import check_determined
from fedic.registration._edges import Strip, across_jacobian
from fedic.registration._features import BoundaryFeature
from fedic.registration._fit import fit_edges, fit_pairs
from fedic.registration._pairs import Pairs, Place, front_parallel_from_pairs, pinhole_from_pairs
from fedic.registration._pose import Placeable, free_parameters
from fedic.registration._problem import Estimate, Group, Problem, for_all_unknowns, pair_groups, unknowns_of
from fedic.registration._search import nearby
from fedic.registration._space import in_space
from fedic.registration._strips import feature_strips
from fedic.registration._target import start_on_target

__all__ = ["from_features", "from_pairs", "on_plane_of_target", "read_as_placed"]

_FEWEST_SEEN = 0.5
"""Fraction of the segments of a feature that must show an edge."""
_POOREST_EDGE_PX = 3.0
_UNSETTLED_PX = 0.5
_POSE = 6


def from_pairs(estimate: Estimate, problem: Problem) -> Estimate:
    """Fit the points, from the start or, if the whole pose is free, from the poses that fit the points of a plane.

    Raises
    ------
    CameraError, SolveError
        If no start sees the points and leads to a pose that they determine; the error of the first start.
    """
    starts = [estimate]
    if estimate.place is None and problem.names == free_parameters(estimate.camera, None):
        points = np.concatenate([pairs.points for pairs in problem.pairs])
        together = Pairs(points, np.concatenate([pairs.pixels for pairs in problem.pairs]))
        cameras: Sequence[Placeable] = (
            pinhole_from_pairs(estimate.camera, together)
            if isinstance(estimate.camera, Pinhole)
            else front_parallel_from_pairs(together)
        )
        starts = [Estimate(camera) for camera in cameras] or starts
    fits: list[Estimate] = []
    faults: list[CameraError | SolveError] = []
    for start in starts:
        try:
            check_determined(pair_groups(start, problem), unknowns_of(start, problem.names))
            fits.append(fit_pairs(start, problem))
        except (CameraError, SolveError) as fault:
            faults.append(fault)
    if not fits:
        raise faults[0]
    return min(fits, key=lambda each: _misfit(each, problem))


def read_as_placed(mesh: Mesh, start: Estimate, problem: Problem, found: Pairs, place: Place, *, turned: bool) -> Pairs:
    """Transform the points of a target to the frame of the mesh, upside down if that is nearer to the start.

    Parameters
    ----------
    mesh, start, problem
        The mesh, the rough start, and the problem without points.
    found : Pairs
        Points in the frame of the target.
    place : Place
        Placement of the target on the mesh.
    turned : bool
        True if the target may have been read upside down.

    Raises
    ------
    CameraError
        If the start is needed for that decision and does not see the mesh.
    """
    readings = [replace(found, points=place.carry(found.points), placed=True)]
    if not turned:
        return readings[0]
    nodes = used_points(mesh)
    wanted = start.camera.project(nodes)
    if not np.isfinite(wanted).all():
        raise CameraError(
            "camera: this target can be read in two directions, and the given pose, which decides between them, does "
            "not see the mesh; give a rough pose."
        )
    ends = found.points.min(axis=0) + found.points.max(axis=0)
    upside_down = np.array([-1.0, -1.0, 1.0]) * found.points + ends * [1.0, 1.0, 0.0]
    readings.append(replace(found, points=place.carry(upside_down), placed=True))

    def distance(reading: Pairs) -> float:
        camera = from_pairs(start, replace(problem, pairs=[reading])).camera
        away = np.linalg.norm(camera.project(nodes) - wanted, axis=1)
        return float(np.median(np.where(np.isfinite(away), away, np.inf)))

    return min(readings, key=distance)


def on_plane_of_target(mesh: Mesh, estimate: Estimate, problem: Problem, pairs: Pairs) -> Estimate:
    """Place the mesh on the plane of a target, as near as possible to its position in the start.

    Raises
    ------
    OptionError
        If a parameter of the pose is held.
    """
    if len(problem.names) < _POSE:
        raise OptionError(
            "free: a target of unknown placement on the mesh needs all of rx ry rz tx ty tz to be free.", "free"
        )
    alone = replace(problem, pairs=(replace(pairs, placed=True),))
    on_target, start = from_pairs(estimate, alone).camera, estimate.camera
    assert isinstance(on_target, Pinhole)
    assert isinstance(start, Pinhole)
    return Estimate(*start_on_target(start, on_target, used_points(mesh)))


def from_features(
    mesh: Mesh, wanted: Sequence[BoundaryFeature], estimate: Estimate, problem: Problem, search: float
) -> tuple[Estimate, list[Group], Problem]:
    """Fit features to their edges; the start is searched for unless points on the mesh determine it.

    Returns
    -------
    Estimate
        The minimum.
    list of Group
        Rows at the minimum: one group for each feature, then those of the points.
    Problem
        The problem with the features.

    Raises
    ------
    CameraError
        If the start puts a feature outside the image.
    ImageError
        If a feature is not found.
    SolveError
        If the features and points do not determine the unknowns.
    """
    unknowns = unknowns_of(estimate, problem.names)
    problem = replace(problem, strips=feature_strips(mesh, wanted, problem.image, estimate.camera, search))
    _check_geometry(estimate, problem, unknowns)
    near = _from_placed_pairs(estimate, problem)
    if near is None:
        names = problem.names if estimate.place is None else ("rz", "tx", "ty")
        camera = nearby(problem.image, estimate.camera, problem.strips, names, search)
        near = Estimate(camera) if estimate.place is None else _back_on_plane(mesh, estimate, camera)
    problem = replace(problem, strips=feature_strips(mesh, wanted, problem.image, near.camera, search))
    estimate, groups, motion = fit_edges(near, problem)
    _check_found(problem.strips, groups, search)
    if motion > _UNSETTLED_PX:
        raise SolveError(
            f"The fit of the features to their edges did not converge: the last step was {motion:.2g} px. Give other "
            "or more features, or hold parameters with free=(...)."
        )
    check_determined(groups, unknowns)
    return estimate, groups, problem


def used_points(mesh: Mesh) -> Floats:
    """Return the nodes of the cells, shape (n, 3)."""
    return in_space(mesh.points[mesh.used_nodes])


def _misfit(estimate: Estimate, problem: Problem) -> float:
    return sum(float(group.residuals @ group.residuals) for group in pair_groups(estimate, problem))


def _from_placed_pairs(estimate: Estimate, problem: Problem) -> Estimate | None:
    """Return the pose of the points alone; None if they do not determine it."""
    if not problem.pairs or not all(pairs.placed for pairs in problem.pairs):
        return None
    try:
        return from_pairs(estimate, problem)
    except SolveError:
        return None


def _back_on_plane(mesh: Mesh, estimate: Estimate, near: Placeable) -> Estimate:
    """Return the estimate on the plane of the target nearest to a camera found by the search."""
    place, camera = estimate.place, estimate.camera
    assert place is not None
    assert isinstance(camera, Pinhole)
    assert isinstance(near, Pinhole)
    translation = np.asarray(camera.translation) + camera.rotation @ [place.x, place.y, 0.0]
    return Estimate(
        *start_on_target(near, with_pose(camera, camera.rotation @ place.turn, translation), used_points(mesh))
    )


def _check_geometry(estimate: Estimate, problem: Problem, unknowns: tuple[str, ...]) -> None:
    """Check, before the search, that exact edges would determine the pose."""
    groups = pair_groups(estimate, problem)
    for strip in problem.strips:
        rows = for_all_unknowns(estimate, across_jacobian(estimate.camera, strip, problem.names))
        groups.append(Group(np.zeros(len(rows)), rows, np.ones(len(rows), dtype=bool), 1.0))
    check_determined(groups, unknowns)


def _check_found(strips: Sequence[Strip], groups: Sequence[Group], search: float) -> None:
    for strip, group in zip(strips, groups, strict=False):
        count, total = int(group.used.sum()), len(group.used)
        if count < _FEWEST_SEEN * total:
            how = f"{count} of its {total} segments show an edge"
        elif group.noise > _POOREST_EDGE_PX:
            how = f"the edges near it scatter by {group.noise:.1f} px"
        else:
            continue
        raise ImageError(
            f"The feature {strip.name!r} is not found in the image: {how}. It may be further than search = {search:g} "
            "px from the given pose (give a better one, point pairs, or a larger search), outside the image, or the "
            "specimen may differ from the mesh."
        )
