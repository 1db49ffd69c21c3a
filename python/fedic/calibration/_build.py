"""Result of a calibration from its fit."""

from pathlib import Path

import numpy as np

from fedic.calibration._adjustment.fit import Fit
from fedic.calibration._adjustment.shape import shape_of
from fedic.calibration._advice import correlation_advice, coverage_advice, parameter_advice, tilt_advice, view_advice
from fedic.calibration._plausibility import check_plausible, tell_shape
from fedic.calibration._result import Calibration, View
from fedic.calibration.lenses import ShapedTarget
from fedic.calibration.observation import Observation
from fedic.errors import OptionError

__all__ = ["build_result"]


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
    camera = camera.cropped(0, 0, *image_size)
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
