"""Registration: the pose of a mesh from point pairs, edges in the image, or a target."""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fedic._core import FrontParallel, Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.calibration.target import Target
from fedic.cameras.image_size import check_image_size
from fedic.errors import ImageError, OptionError, QualityWarning
from fedic.io.images import as_image
from fedic.registration._covariance import check_determined, check_known, covariance_of
from fedic.registration._doubts import doubts_of
from fedic.registration._features import BoundaryFeature, chosen_features, listed_features
from fedic.registration._numbers import finite_number
from fedic.registration._orientations import best_orientation
from fedic.registration._pairs import Pairs, check_not_mirrored, checked_pairs
from fedic.registration._pose import free_parameters, placeable
from fedic.registration._problem import Estimate, Group, Problem, pair_groups, unknowns_of
from fedic.registration._result import FeatureDistances, Registration
from fedic.registration._steps import from_pairs, on_plane_of_target, read_as_placed
from fedic.registration._target import lying_target, target_pairs

__all__ = ["register"]

Features: TypeAlias = Sequence[str | BoundaryFeature]

_FEWEST_TO_JUDGE = 6
"""Number of points, beside other data, from which their noise is estimated from the residuals."""
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
    """Estimate the pose of a camera in the frame of a mesh from an image of the specimen.

    The data are any of, or several together: points of the mesh with their image points; features of the mesh's
    boundary, whose edges are searched for in the image around a rough start; a calibration target on the specimen. For
    a front-parallel camera the scale is estimated too; for a pinhole it follows from the calibration, whose lens and
    focal lengths are kept.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    image : ndarray, shape (height, width)
        Image of the specimen, such as the reference image of the measurement.
    camera : FrontParallel or Pinhole
        Rough start; for a pinhole also the calibration. The start has no influence on the pose of a pinhole estimated
        from at least four coplanar points; with a target of known placement on the mesh it only decides which way up
        the target is.
    points : (array_like (m, 2) or (m, 3), array_like (m, 2)), optional
        Points in the frame of the mesh, and their image points ``(u, v)``.
    features : sequence of str or BoundaryFeature
        Parts of the boundary, see `fedic.boundary_features`.
    target : str or Target, optional
        Target, such as ``"chessboard:11x7:8"`` (see `fedic.calibration.parse_target`), in the unit of the mesh; for a
        pinhole only.
    target_origin : (float, float), optional
        Origin of the target (`fedic.calibration.Target`) in the frame of the mesh. Without it the target determines the
        plane of the specimen, and features or points the position in that plane.
    target_angle : float, optional
        Angle from the X axis of the mesh to that of the target in radians, zero by default; needs `target_origin`.
    target_thickness : float
        Height of the printed face above the plane Z = 0 of the mesh, in the mesh's unit.
    free : sequence of str, optional
        Parameters to estimate: any of ``u0 v0 angle scale`` (front-parallel), or of ``rx ry rz tx ty tz`` (pinhole:
        rotations about the camera's axes, translation). By default all.
    pixel_noise : float, optional
        Standard deviation of a coordinate of the given image points. By default estimated from the residuals; fewer
        than six points beside features or a target are assumed to have 0.5 px.
    search : float
        Largest distance in pixels between the centre of the features and its position in the start; rotations up to 4
        degrees and changes of scale up to 6 % are searched too. Zero if the start is right to a few pixels.

    Returns
    -------
    Registration
        The camera, its covariance, and the residuals of each feature and point.

    Raises
    ------
    OptionError
        If the camera has no pose, a feature is unknown, or another argument is malformed or out of its range.
    CameraError
        If the camera does not see the mesh in the image, or is that of images of another size.
    ImageError
        If a feature or the target is not found in the image, or the image is not finite.
    SolveError
        If the data do not determine the free parameters.

    Warns
    -----
    QualityWarning
        For each sentence of `Registration.doubts`: a feature whose edge lies to one side of it all along, or a mesh
        that fits better turned by 180 degrees or mirrored. Without points or a target, a poor fit of features is tried
        with the mesh turned too, and the better one is returned.
    """
    grey = _finite(as_image(image, "given"))
    if pixel_noise is not None and finite_number("pixel_noise", pixel_noise, _NOISE) <= 0.0:
        raise OptionError(f"pixel_noise={pixel_noise}: give {_NOISE}.", "pixel_noise")
    if finite_number("search", search, _SEARCH) < 0.0:
        raise OptionError(f"search={search}: give {_SEARCH}.", "search")
    lying = lying_target(target, target_origin, target_angle, target_thickness)
    start = placeable(camera)
    check_image_size(start, grey.shape, "given")
    names = free_parameters(start, free)
    wanted = chosen_features(mesh, features)
    pairs = [] if points is None else [_inside(grey, checked_pairs(points))]
    if pairs:
        if isinstance(start, FrontParallel):
            check_not_mirrored(pairs[0])
        few = len(pairs[0].points) < _FEWEST_TO_JUDGE and (len(wanted) > 0 or lying is not None)
        known = few or pixel_noise is not None
        pairs = [replace(pairs[0], noise=_EXPECTED_NOISE_PX if pixel_noise is None else pixel_noise, known=known)]
    if not pairs and not wanted and lying is None:
        listed = listed_features(mesh)
        raise OptionError(f"register: give points, features or a target; the features are{listed}", "features")

    estimate, problem = Estimate(start), Problem(grey, names)
    if lying is not None:
        if lying.place is None and not pairs and not wanted:
            raise OptionError(
                "target: it determines the plane of the specimen only; give target_origin=(x, y), features or points "
                "to determine the position in that plane.",
                "target_origin",
            )
        found = target_pairs(grey, start, lying)
        if lying.place is None:
            estimate = on_plane_of_target(mesh, estimate, problem, found)
        else:
            turned = lying.plan.kind != "charuco"
            found = read_as_placed(mesh, estimate, problem, found, lying.place, turned=turned)
        pairs.append(found)
    problem = Problem(grey, names, (), pairs)
    orientation = ""
    if wanted:
        estimate, groups, problem, orientation = best_orientation(mesh, wanted, estimate, problem, search)
    else:
        estimate = from_pairs(estimate, problem)
        groups = pair_groups(estimate, problem)
        check_determined(groups, unknowns_of(estimate, names))
    registration = _assembled(mesh, estimate, problem, groups, orientation)
    for sentence in registration.doubts:
        warnings.warn(sentence, QualityWarning, stacklevel=2)
    return registration


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
        raise OptionError(
            f"points: pixel number {number} at ({u:g}, {v:g}) is outside the image of {width} x {height} px; give "
            "(u, v), the column first.",
            "points",
        )
    return pairs


def _assembled(mesh: Mesh, estimate: Estimate, problem: Problem, groups: list[Group], orientation: str) -> Registration:
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
    return Registration(
        camera=estimate.camera,
        free=names,
        covariance=covariance,
        standard_deviations=deviations,
        features=found,
        points=points,
        pixels=pixels,
        residuals=pixels - estimate.camera.project(points),
        mesh=mesh,
        image=problem.image,
        doubts=(*([orientation] if orientation else []), *doubts_of(found.values())),
    )


def _points(estimate: Estimate, problem: Problem) -> tuple[Floats, Floats]:
    """Return all points in the frame of the mesh, and their pixels."""
    points, pixels = [np.empty((0, 3))], [np.empty((0, 2))]
    for pairs in problem.pairs:
        carried = pairs.placed or estimate.place is None
        points.append(pairs.points if carried else estimate.place.carry(pairs.points))  # type: ignore[union-attr]
        pixels.append(pairs.pixels)
    return np.concatenate(points), np.concatenate(pixels)
