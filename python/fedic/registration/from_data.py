"""`register`: the pose of a mesh from point pairs, edges in the image, or a target."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fedic._core import Mesh, Pinhole
from fedic._types import Floats, Image
from fedic.calibration.target import Target
from fedic.errors import CameraError, ImageError, MeshError
from fedic.images import as_image
from fedic.registration.covariance import check_determined, check_known, covariance_of
from fedic.registration.edges import Strip, across_jacobian, prepare_strip
from fedic.registration.features import BoundaryFeature, chosen_features
from fedic.registration.fit import Estimate, Group, Problem, fit_edges, fit_pairs, for_all_unknowns, pair_group
from fedic.registration.pairs import Pairs, Place, checked_pairs, pair_rows, pinhole_from_pairs
from fedic.registration.pose import Placeable, free_parameters, posed
from fedic.registration.result import FeatureDistances, Registration
from fedic.registration.sampling import sample_feature
from fedic.registration.search import nearby
from fedic.registration.target import start_on_target, target_pairs

__all__ = ["register"]

Features: TypeAlias = Sequence[str | BoundaryFeature]

_BLOCK_PX = 12.0
_FEWEST_SEEN = 0.5
"""Part of the pieces of a feature that must show an edge."""
_POOREST_EDGE_PX = 3.0
_LEAST_IN_IMAGE = 0.3
_PLACE = ("target x", "target y", "target angle")


def register(
    mesh: Mesh,
    image: Image,
    camera: Placeable,
    *,
    points: tuple[ArrayLike, ArrayLike] | None = None,
    features: Features = (),
    target: str | Target | None = None,
    target_origin: tuple[float, float] | None = None,
    target_angle: float = 0.0,
    target_thickness: float = 0.0,
    free: Sequence[str] | None = None,
    pixel_noise: float | None = None,
    search: float = 60.0,
) -> Registration:
    """Find where a mesh is in an image: the pose of a camera in the frame of the mesh.

    From any of three sources. Points of the mesh and the pixels they are seen at; features of the mesh's boundary, whose
    edges are looked for in the image around a rough start; a calibration target that lies on the specimen. The scale is
    found with a front-parallel camera, and comes from the calibration with a pinhole, whose lens and focal length are kept.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    image : ndarray, shape (height, width)
        The specimen, as in the reference image of the measurement.
    camera : FrontParallel or Pinhole
        The rough start; for a pinhole also the calibration. A pose from four points in a plane, or from a target that
        is placed on the mesh, needs no start.
    points : (array_like (m, 2) or (m, 3), array_like (m, 2)), optional
        Points in the frame of the mesh, and their pixels ``(u, v)``.
    features : sequence of str or BoundaryFeature
        Pieces of the boundary, see `fedic.boundary_features`.
    target : str or Target, optional
        Such as ``"chessboard:11x7:8"``, see `fedic.calibration.parse_target`; its unit is that of the mesh. For a pinhole.
    target_origin : (float, float), optional
        Where the origin of the target (`fedic.calibration.Target`) is in the frame of the mesh. If not given, the target
        gives the plane of the specimen, and features or points the place in it.
    target_angle : float
        Angle from the X axis of the mesh to that of the target, in radians, where its origin is given.
    target_thickness : float
        Height of the printed face above the plane Z = 0 of the mesh, in the mesh's unit.
    free : sequence of str, optional
        The parameters to find: of ``u0 v0 angle scale`` (front-parallel), or of ``rx ry rz tx ty tz`` (pinhole: rotations
        about the camera's axes, translation). All if not given.
    pixel_noise : float, optional
        Standard deviation of a coordinate of a point's pixel, for the covariance; from the residuals if not given.
    search : float
        How far, in pixels, the centre of the features may be from where the start puts it, besides a turn of 4 degrees
        and 6 % of scale; zero if the start is right to some pixels.

    Returns
    -------
    Registration
        The camera, its covariance, and what is left at each feature and point.

    Raises
    ------
    CameraError
        If the camera has no pose, does not see the mesh in the image, or an argument is malformed.
    MeshError
        If a feature is unknown.
    ImageError
        If a feature or the target is not found in the image.
    SolveError
        If the data do not determine the free parameters.
    """
    grey = as_image(image, "given")
    names = free_parameters(camera, free)
    wanted = chosen_features(mesh, features)
    pairs = None if points is None else checked_pairs(points)
    if pairs is None and not wanted and target is None:
        raise CameraError("register: give points=(points, pixels), features=[...] or target=..., to place the mesh by.")
    if pixel_noise is not None and not 0.0 < pixel_noise < np.inf:
        raise CameraError(f"pixel_noise={pixel_noise}: give a positive number of pixels.")
    if not 0.0 <= search < np.inf:
        raise CameraError(f"search={search}: give a number of pixels, zero or more.")

    estimate = Estimate(camera)
    if target is not None:
        if pairs is not None:
            raise CameraError("register: give point pairs or a target, not both; a target's points are pairs already.")
        pairs = target_pairs(grey, camera, target, target_thickness)
        estimate, pairs = _on_target(mesh, estimate, pairs, target_origin, target_angle, bool(wanted), names)
    problem = Problem(grey, names, (), pairs, pixel_noise)
    unknowns = (*names, *(_PLACE if estimate.place is not None else ()))
    groups: list[Group] = []
    if pairs is not None:
        _check_inside(grey, pairs.pixels)
        if not wanted or pairs.placed:
            estimate = _best_from_pairs(estimate, problem)
        groups = [pair_group(estimate, problem)]
    if wanted:
        estimate, groups, problem = _with_features(mesh, wanted, estimate, problem, unknowns, search)
    else:
        check_determined(groups, unknowns)
    covariance, noises = covariance_of(groups, pixel_noise)
    covariance = covariance[: len(names), : len(names)]
    deviations = dict(zip(names, map(float, np.sqrt(np.diag(covariance))), strict=True))
    check_known(names, list(deviations.values()), estimate.camera)
    found = {
        strip.name: FeatureDistances(strip.name, group.edge.pixels, group.residuals, group.used, noise)
        for strip, group, noise in zip(problem.strips, groups, noises, strict=False)
        if group.edge is not None
    }
    seen = _seen_points(estimate, problem)
    return Registration(estimate.camera, names, covariance, deviations, found, *seen, mesh, grey)


def _on_target(
    mesh: Mesh,
    estimate: Estimate,
    pairs: Pairs,
    origin: tuple[float, float] | None,
    angle: float,
    with_features: bool,
    names: tuple[str, ...],
) -> tuple[Estimate, Pairs]:
    """Place a target on the mesh, or the mesh on the plane of the target."""
    if origin is not None:
        place = Place(float(origin[0]), float(origin[1]), float(angle))
        return estimate, Pairs(place.carry(pairs.points), pairs.pixels)
    if not with_features:
        raise CameraError(
            "target: it gives the plane of the specimen; say where it lies on the mesh, target_origin=(x, y), or give "
            "features to find the place by."
        )
    if len(names) < 6:
        raise CameraError("free: a target whose place on the mesh is unknown determines all of rx ry rz tx ty tz.")
    assert isinstance(estimate.camera, Pinhole)
    on_target = _best_from_pairs(estimate, Problem(np.empty((0, 0), np.uint8), names, (), Pairs(pairs.points, pairs.pixels)))
    assert isinstance(on_target.camera, Pinhole)
    return Estimate(*start_on_target(estimate.camera, on_target.camera, _used_points(mesh))), pairs


def _best_from_pairs(estimate: Estimate, problem: Problem) -> Estimate:
    """Fit the points, from the start and, where the whole pose is free, from the poses their plane allows."""
    pairs, names = problem.pairs, problem.names
    assert pairs is not None
    starts = [estimate]
    if isinstance(estimate.camera, Pinhole) and len(names) == 6:
        starts = [Estimate(camera) for camera in pinhole_from_pairs(estimate.camera, pairs)] or starts
    check_determined([pair_group(start, problem) for start in starts[:1]], names)
    fitted = [fit_pairs(start, problem) for start in starts]
    return min(fitted, key=lambda each: float((pair_rows(each.camera, None, pairs, names)[0] ** 2).sum()))


def _with_features(
    mesh: Mesh,
    wanted: list[BoundaryFeature],
    estimate: Estimate,
    problem: Problem,
    unknowns: tuple[str, ...],
    search: float,
) -> tuple[Estimate, list[Group], Problem]:
    """Bring the features to their edges."""
    strips = _strips(mesh, wanted, problem.image, estimate.camera, search)
    problem = replace(problem, strips=strips)
    _check_geometry(estimate, problem, unknowns)
    placed = problem.pairs is not None and problem.pairs.placed
    if not placed:
        names = problem.names if estimate.place is None else ("rz", "tx", "ty")
        near = nearby(problem.image, estimate.camera, strips, names, search)
        estimate = _refreshed(mesh, estimate, near)
        strips = _strips(mesh, wanted, problem.image, estimate.camera, search)
        problem = replace(problem, strips=strips)
    estimate, groups = fit_edges(estimate, problem)
    _check_found(strips, groups, search)
    check_determined(groups, unknowns)
    return estimate, groups, problem


def _refreshed(mesh: Mesh, estimate: Estimate, near: Placeable) -> Estimate:
    """Take over the camera the search found; on the plane of a target, put back on that plane."""
    if estimate.place is None:
        return Estimate(near)
    assert isinstance(near, Pinhole)
    assert isinstance(estimate.camera, Pinhole)
    place, posed_camera = estimate.place, estimate.camera
    translation = np.asarray(posed_camera.translation) + posed_camera.rotation @ [place.x, place.y, 0.0]
    on_target = posed(posed_camera, posed_camera.rotation @ place.turn, translation)
    return Estimate(*start_on_target(near, on_target, _used_points(mesh)))


def _strips(
    mesh: Mesh, wanted: list[BoundaryFeature], image: Image, camera: Placeable, search: float
) -> list[Strip]:
    height, width = image.shape
    strips = []
    for feature in wanted:
        samples = sample_feature(mesh, feature, camera, _BLOCK_PX)
        seen = camera.project(samples.points)
        inside = np.all((seen >= -search) & (seen <= np.array([width, height]) - 1.0 + search), axis=1)
        if inside.mean() < _LEAST_IN_IMAGE:
            u, v = np.round(seen.mean(axis=0))
            raise CameraError(
                f"camera: the start puts the feature {feature.name!r} around ({u:.0f}, {v:.0f}), out of the image of "
                f"{width} x {height} px; correct the start."
            )
        strips.append(prepare_strip(feature.name, mesh, samples, camera))
    return strips


def _check_geometry(estimate: Estimate, problem: Problem, unknowns: tuple[str, ...]) -> None:
    """Check, before the search, that perfect edges would determine the pose."""
    groups = []
    for strip in problem.strips:
        rows = for_all_unknowns(estimate, across_jacobian(estimate.camera, strip, problem.names))
        groups.append(Group(np.zeros(len(rows)), rows, np.ones(len(rows), dtype=bool), 1.0))
    if problem.pairs is not None:
        groups.append(pair_group(estimate, problem))
    check_determined(groups, unknowns)


def _check_found(strips: list[Strip], groups: list[Group], search: float) -> None:
    for strip, group in zip(strips, groups, strict=False):
        count, total = int(group.used.sum()), len(group.used)
        if count < _FEWEST_SEEN * total or group.noise > _POOREST_EDGE_PX:
            how = f"{count} of its {total} pieces show an edge" if count < _FEWEST_SEEN * total else (
                f"the edges near it scatter by {group.noise:.1f} px"
            )
            raise ImageError(
                f"The feature {strip.name!r} is not found in the image: {how}. The start may be more than search = "
                f"{search:g} px away (give a better one, points, or a larger search), or the image may not show it."
            )


def _check_inside(image: Image, pixels: Floats) -> None:
    height, width = image.shape
    outside = np.flatnonzero(np.any((pixels < -0.5) | (pixels > np.array([width, height]) - 0.5), axis=1))
    if len(outside):
        u, v = pixels[outside[0]]
        raise CameraError(
            f"points: pixel number {outside[0]} at ({u:g}, {v:g}) is out of the image of {width} x {height} px; give (u, v), "
            "the column first."
        )


def _used_points(mesh: Mesh) -> Floats:
    points = mesh.points[mesh.used_nodes]
    if not len(points):
        raise MeshError("The mesh has no cell.")
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def _seen_points(estimate: Estimate, problem: Problem) -> tuple[Floats, Floats, Floats]:
    pairs = problem.pairs
    if pairs is None:
        return np.empty((0, 3)), np.empty((0, 2)), np.empty((0, 2))
    points = pairs.points if pairs.placed or estimate.place is None else estimate.place.carry(pairs.points)
    return points, pairs.pixels, pairs.pixels - estimate.camera.project(points)
