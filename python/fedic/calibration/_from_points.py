"""Calibration of a camera from points of a target that are already found."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from fedic._internal.determinacy import LARGEST_RELATIVE_DEVIATION
from fedic.calibration._adjustment.fit import Fit, fit
from fedic.calibration._adjustment.shape import fit_shape, shape_of
from fedic.calibration._adjustment.spline_fit import fit_spline
from fedic.calibration._adjustment.start import initial_estimate
from fedic.calibration._advice import correlation_advice, coverage_advice, parameter_advice, tilt_advice, view_advice
from fedic.calibration._plausibility import check_plausible, tell_shape
from fedic.calibration._result import Calibration, View
from fedic.calibration.lenses import BROWN, CoefficientLens, ShapedTarget, parse_lens
from fedic.calibration.observation import Observation
from fedic.errors import CameraError, OptionError

__all__ = ["build_result", "calibrate_points", "fit_or_explain", "fit_with_shape"]


def calibrate_points(
    points: Sequence[ArrayLike],
    pixels: Sequence[ArrayLike],
    image_size: tuple[int, int],
    distortion: str | Sequence[str] = "radial1",
    *,
    view: int | str | None = None,
) -> Calibration:
    """Calibrate a camera from points found by other means.

    Parameters
    ----------
    points : sequence of array_like, shape (n, 2) or (n, 3)
        Points of a flat target in each view, with Z = 0.
    pixels : sequence of array_like, shape (n, 2)
        Their image points.
    image_size : (int, int)
        Width and height in pixels.
    distortion, view
        See `calibrate`; the views are named ``"image 0"``, ``"image 1"``, ...

    Returns
    -------
    Calibration
        The camera, its uncertainty, and the residuals of each view.

    Raises
    ------
    OptionError
        If the arrays do not fit together, or an argument is malformed.
    CameraError
        If the views do not determine the camera, or the camera found cannot be right.

    Warns
    -----
    CalibrationWarning
        If the target is not as given (see `Calibration.target_shape`), or the camera found is hardly plausible.
    """
    lens = parse_lens(distortion)
    if len(points) != len(pixels):
        raise OptionError(
            f"{len(points)} views have points and {len(pixels)} have pixels; give one of each per view.", "points"
        )
    pairs = enumerate(zip(points, pixels, strict=True))
    seen = [_observation(index, *pair) for index, pair in pairs]
    names = [f"image {index}" for index in range(len(seen))]
    found = list(range(len(seen)))
    return build_result(seen, found, names, {}, fit_with_shape(lens, seen, image_size), image_size, view)


def _observation(index: int, points: ArrayLike, pixels: ArrayLike) -> Observation:
    where, at = np.asarray(points, dtype=np.float64), np.asarray(pixels, dtype=np.float64)
    if where.ndim == 2 and where.shape[1] == 2:
        where = np.column_stack([where, np.zeros(len(where))])
    if where.ndim != 2 or where.shape[1] != 3 or at.shape != (len(where), 2) or len(where) < 4:
        raise OptionError(
            f"image {index}: points of shape {where.shape} and pixels of shape {at.shape}; give (n, 2) or (n, 3) and "
            "(n, 2), with n at least 4.",
            "points",
        )
    if not (np.isfinite(where).all() and np.isfinite(at).all()) or np.any(where[:, 2] != 0.0):
        raise OptionError(
            f"image {index}: the points must be finite, with Z = 0 on the target, and the pixels finite.", "points"
        )
    return Observation(where, at)


def fit_or_explain(lens: CoefficientLens | str, seen: list[Observation], image_size: tuple[int, int]) -> Fit:
    """Fit a camera; if that fails, add the likely cause in the directions of the views to the message.

    Parameters
    ----------
    lens : CoefficientLens or str
        Lens model, or the name of a non-parametric one.
    seen : list of Observation
        One per view.
    image_size : (int, int)
        Width and height in pixels.

    Returns
    -------
    Fit
        The minimum.

    Raises
    ------
    CameraError
        If the views do not determine the camera, or the fit does not converge.
    """
    try:
        found = fit_spline(lens, seen, image_size) if isinstance(lens, str) else fit(lens, seen, image_size)
        values, deviations = found.estimate.intrinsics[:2], np.sqrt(np.diag(found.covariance)[:2])
        if np.any(deviations > LARGEST_RELATIVE_DEVIATION * values):
            raise CameraError(f"The views do not determine the focal length: {values[0]:.4g} ± {deviations[0]:.2g} px.")
    except (CameraError, np.linalg.LinAlgError) as fault:
        what = str(fault) if isinstance(fault, CameraError) else "The views do not determine the camera."
        raise CameraError(" ".join([what, *_causes(seen, image_size)])) from None
    return found


def fit_with_shape(lens: CoefficientLens | str, seen: list[Observation], image_size: tuple[int, int]) -> Fit:
    """Fit a camera, and the shape of the target if it is not as planned; see `fit_or_explain` and `fit_shape`.

    Parameters
    ----------
    lens : CoefficientLens or str
        Lens model, or the name of a non-parametric one.
    seen : list of Observation
        One per view.
    image_size : (int, int)
        Width and height in pixels.

    Returns
    -------
    Fit
        The minimum.

    Raises
    ------
    CameraError
        If the views do not determine the camera, or the fit does not converge.
    """
    return fit_shape(fit_or_explain(lens, seen, image_size), seen, image_size)


def _causes(seen: list[Observation], image_size: tuple[int, int]) -> list[str]:
    """Return advice on the directions of the views, as estimated before the fit."""
    try:
        return tilt_advice(initial_estimate(BROWN, seen, image_size).rotations) if len(seen) > 1 else []
    except CameraError:
        return []


def build_result(
    seen: list[Observation],
    found: list[int],
    names: list[str],
    faults: dict[int, str],
    final: Fit,
    image_size: tuple[int, int],
    wanted: int | str | None,
) -> Calibration:
    """Build the result of a calibration.

    Parameters
    ----------
    seen : list of Observation
        Points of the views `found`.
    found : list of int
        Indices of the images in which the target was found.
    names : list of str
        Names of all images.
    faults : dict of int to str
        Reasons for the other images.
    final : Fit
        The fit to `seen`.
    image_size : (int, int)
        Width and height in pixels.
    wanted : int or str, optional
        View whose pose the camera takes.

    Returns
    -------
    Calibration
        The result.

    Raises
    ------
    OptionError
        If there is no view `wanted`.
    CameraError
        If the camera found cannot be right.
    """
    places = {index: place for place, index in enumerate(found)}
    views = tuple(
        _seen_view(name, seen[places[index]], final, places[index])
        if index in places
        else _missing_view(name, faults[index])
        for index, name in enumerate(names)
    )
    chosen = _chosen(views, wanted)
    lens, shape = final.lens, shape_of(final)
    named = len(lens.parameters)
    parameters = dict(zip(lens.parameters, map(float, final.estimate.intrinsics[:named]), strict=True))
    deviations = dict(zip(lens.parameters, map(float, np.sqrt(np.diag(final.covariance)[:named])), strict=True))
    counted = np.concatenate([view.residuals[view.used] for view in views if view.accepted])
    error = float(np.sqrt((counted**2).sum(axis=1).mean()))
    advice = [
        *view_advice(len(final.accepted), error),
        *tilt_advice(final.estimate.rotations[final.accepted]),
        *coverage_advice(np.concatenate([view.pixels[view.used] for view in views if view.accepted]), image_size),
        *parameter_advice(parameters, deviations, image_size),
        *correlation_advice(lens.parameters, final.covariance),
    ]
    camera = lens.camera(final.estimate.intrinsics, views[chosen].rotation, views[chosen].translation)
    check_plausible(parameters, deviations, error, image_size)
    if isinstance(lens, ShapedTarget):
        tell_shape(shape, lens.half)
    of_shape = np.arange(lens.size - len(shape), lens.size)
    covariance = np.delete(np.delete(final.covariance, of_shape, axis=0), of_shape, axis=1)
    return Calibration(
        camera, chosen, error, views, parameters, deviations, covariance, image_size, advice, lens.name, shape
    )


def _seen_view(name: str, seen: Observation, final: Fit, place: int) -> View:
    lens, points = final.lens, seen.points
    if isinstance(lens, ShapedTarget):
        points = lens.shaped(final.estimate.intrinsics, points)
    return View(
        name=name,
        found=True,
        accepted=place in final.accepted,
        reason=final.reasons.get(place, ""),
        points=points,
        pixels=seen.pixels,
        residuals=final.residuals[place],
        used=final.used[place],
        initial_error=float(final.initial_errors[place]),
        final_error=float(final.final_errors[place]),
        rotation=final.estimate.rotations[place],
        translation=final.estimate.translations[place],
    )


def _missing_view(name: str, reason: str) -> View:
    nothing = np.empty((0, 2))
    unknown = float("nan")
    used = np.empty(0, dtype=bool)
    pose = np.full((3, 3), unknown), np.full(3, unknown)
    return View(name, False, False, reason, np.empty((0, 3)), nothing, nothing, used, unknown, unknown, *pose)


def _chosen(views: tuple[View, ...], wanted: int | str | None) -> int:
    """Return the index of the view whose pose the camera takes."""
    if wanted is None:
        return next(index for index, view in enumerate(views) if view.accepted)
    if isinstance(wanted, str):
        matches = [index for index, view in enumerate(views) if wanted in (view.name, Path(view.name).name)]
    else:
        matches = [wanted] if 0 <= wanted < len(views) else []
    if not matches:
        raise OptionError(
            f"view {wanted!r}: there is no such view; they are {', '.join(view.name for view in views)}.", "view"
        )
    view = views[matches[0]]
    if not view.found:
        raise OptionError(f"view {wanted!r}: the target was not found in {view.name}: {view.reason}.", "view")
    return matches[0]
