"""`register`: the pose of a mesh from point pairs, edges in the image, or a target."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fedic._core import Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.calibration.target import Target
from fedic.errors import CameraError, ImageError
from fedic.io.images import as_image
from fedic.registration._covariance import check_determined, check_known, covariance_of
from fedic.registration._features import BoundaryFeature, chosen_features, listed_features
from fedic.registration._numbers import finite_number
from fedic.registration._pairs import Pairs, checked_pairs
from fedic.registration._pose import free_parameters, placeable
from fedic.registration._problem import Estimate, Group, Problem, pair_groups, unknowns_of
from fedic.registration._result import FeatureDistances, Registration
from fedic.registration._steps import from_features, from_pairs, on_plane_of_target, read_as_placed
from fedic.registration._target import lying_target, target_pairs

__all__ = ["register"]

Features: TypeAlias = Sequence[str | BoundaryFeature]

_FEWEST_TO_JUDGE = 6
"""Points beside other data from which their noise is taken from what is left."""
_EXPECTED_NOISE_PX = 0.5
_NOISE = "a positive number of pixels"
_SEARCH = "a number of pixels, zero or more"


def register(
    mesh: Mesh,
    image: Image,
    camera: Camera,
    *,
    points: tuple[ArrayLike, ArrayLike] | None = None,
    features: Features = (),
    target: str | Target | None = None,
    target_origin: tuple[float, float] | None = None,
    target_angle: float | None = None,
    target_thickness: float = 0.0,
    free: Sequence[str] | None = None,
    pixel_noise: float | None = None,
    search: float = 60.0,
) -> Registration:
    """Find where a mesh is in an image: the pose of a camera in the frame of the mesh.

    From any of three sources, or several together: points of the mesh and the pixels they are seen at; features of the
    mesh's boundary, whose edges are looked for in the image around a rough start; a calibration target that lies on the
    specimen. With a front-parallel camera the scale is found too; with a pinhole it comes from the calibration, and the
    lens and the focal lengths are kept.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    image : ndarray, shape (height, width)
        The specimen, as in the reference image of the measurement.
    camera : FrontParallel or Pinhole
        The rough start; for a pinhole also the calibration. The whole pose of a pinhole from four points in a plane or
        more does not depend on the start; with a target whose place on the mesh is given, the start only tells which
        way up the target is.
    points : (array_like (m, 2) or (m, 3), array_like (m, 2)), optional
        Points in the frame of the mesh, and their pixels ``(u, v)``.
    features : sequence of str or BoundaryFeature
        Pieces of the boundary, see `fedic.boundary_features`.
    target : str or Target, optional
        Such as ``"chessboard:11x7:8"``, see `fedic.calibration.parse_target`, in the unit of the mesh; for a pinhole.
    target_origin : (float, float), optional
        Where the origin of the target (`fedic.calibration.Target`) is in the frame of the mesh. If not given, the
        target gives the plane of the specimen, and features or points the place in it.
    target_angle : float, optional
        Angle from the X axis of the mesh to that of the target, in radians, where its origin is given; zero if not
        given.
    target_thickness : float
        Height of the printed face above the plane Z = 0 of the mesh, in the mesh's unit.
    free : sequence of str, optional
        The parameters to find: of ``u0 v0 angle scale`` (front-parallel), or of ``rx ry rz tx ty tz`` (pinhole:
        rotations about the camera's axes, translation). All if not given.
    pixel_noise : float, optional
        Standard deviation of a coordinate of a given point's pixel. If not given it comes from the residuals, or,
        beside features or a target, is taken to be 0.5 px where there are fewer than six points.
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
        If a feature or the target is not found in the image, or the image is not finite.
    SolveError
        If the data do not determine the free parameters, or the search is too wide.
    """
    grey = _finite(as_image(image, "given"))
    if pixel_noise is not None and finite_number("pixel_noise", pixel_noise, _NOISE) <= 0.0:
        raise CameraError(f"pixel_noise={pixel_noise}: give {_NOISE}.")
    if finite_number("search", search, _SEARCH) < 0.0:
        raise CameraError(f"search={search}: give {_SEARCH}.")
    lying = lying_target(target, target_origin, target_angle, target_thickness)
    start = placeable(camera)
    names = free_parameters(start, free)
    wanted = chosen_features(mesh, features)
    pairs = [] if points is None else [_inside(grey, checked_pairs(points))]
    if pairs:
        few = len(pairs[0].points) < _FEWEST_TO_JUDGE and (len(wanted) > 0 or lying is not None)
        known = few or pixel_noise is not None
        pairs = [replace(pairs[0], noise=_EXPECTED_NOISE_PX if pixel_noise is None else pixel_noise, known=known)]
    if not pairs and not wanted and lying is None:
        listed = listed_features(mesh)
        raise CameraError(f"register: give points, features or a target to place the mesh by; the features are{listed}")

    estimate, problem = Estimate(start), Problem(grey, names)
    if lying is not None:
        if lying.place is None and not pairs and not wanted:
            raise CameraError(
                "target: it gives the plane of the specimen; say where it lies on the mesh, target_origin=(x, y), or "
                "give features or points to find the place by."
            )
        found = target_pairs(grey, start, lying)
        if lying.place is None:
            estimate = on_plane_of_target(mesh, estimate, problem, found)
        else:
            turned = lying.plan.kind != "charuco"
            found = read_as_placed(mesh, estimate, problem, found, lying.place, turned=turned)
        pairs.append(found)
    problem = Problem(grey, names, (), pairs)
    if wanted:
        estimate, groups, problem = from_features(mesh, wanted, estimate, problem, search)
    else:
        estimate = from_pairs(estimate, problem)
        groups = pair_groups(estimate, problem)
        check_determined(groups, unknowns_of(estimate, names))
    return _assembled(mesh, estimate, problem, groups)


def _finite(image: Image) -> Image:
    if image.dtype.kind == "f" and not np.isfinite(image.sum(dtype=np.float64)):
        v, u = np.argwhere(~np.isfinite(image))[0]
        raise ImageError(f"The given image is {image[v, u]} at (u, v) = ({u}, {v}); give finite grey levels.")
    return image


def _inside(image: Image, pairs: Pairs) -> Pairs:
    height, width = image.shape
    outside = np.any((pairs.pixels < -0.5) | (pairs.pixels > np.array([width, height]) - 0.5), axis=1)
    if outside.any():
        number = int(outside.argmax())
        u, v = pairs.pixels[number]
        raise CameraError(
            f"points: pixel number {number} at ({u:g}, {v:g}) is out of the image of {width} x {height} px; give "
            "(u, v), the column first."
        )
    return pairs


def _assembled(mesh: Mesh, estimate: Estimate, problem: Problem, groups: list[Group]) -> Registration:
    names = problem.names
    covariance, noises = covariance_of(groups)
    covariance = covariance[: len(names), : len(names)]
    deviations = dict(zip(names, map(float, np.sqrt(np.diag(covariance))), strict=True))
    check_known(names, list(deviations.values()), estimate.camera)
    found = {
        strip.name: FeatureDistances(strip.name, group.edge.pixels, group.residuals, group.used, noise)
        for strip, group, noise in zip(problem.strips, groups, noises, strict=False)
        if group.edge is not None
    }
    points, pixels = _points(estimate, problem)
    residuals = pixels - estimate.camera.project(points)
    return Registration(
        estimate.camera, names, covariance, deviations, found, points, pixels, residuals, mesh, problem.image
    )


def _points(estimate: Estimate, problem: Problem) -> tuple[Floats, Floats]:
    """Return all points in the frame of the mesh, and their pixels."""
    points, pixels = [np.empty((0, 3))], [np.empty((0, 2))]
    for pairs in problem.pairs:
        carried = pairs.placed or estimate.place is None
        points.append(pairs.points if carried else estimate.place.carry(pairs.points))  # type: ignore[union-attr]
        pixels.append(pairs.pixels)
    return np.concatenate(points), np.concatenate(pixels)
