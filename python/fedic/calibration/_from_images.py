"""Calibration of a camera from images of a target."""

import glob
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from os import PathLike, fspath
from typing import TypeAlias

from fedic._internal.types import Image, StrPath
from fedic._internal.warning_level import levels_within_fedic
from fedic.calibration._adjustment.shape import fit_shape
from fedic.calibration._build import build_result
from fedic.calibration._from_points import fit_or_explain
from fedic.calibration._result import Calibration
from fedic.calibration.detection import NotFoundError, WrongCountError, find_target, refine_points
from fedic.calibration.lenses import BROWN, CoefficientLens, parse_lens
from fedic.calibration.observation import Observation
from fedic.calibration.target import Target, parse_target
from fedic.errors import CalibrationWarning, CameraError, ImageError
from fedic.io.images import as_image, read_image
from fedic.progress import ProgressCallback, fraction_callback

__all__ = ["calibrate"]

Source: TypeAlias = StrPath | Image
_CAUSES_SHOWN = 5


def calibrate(
    images: str | Sequence[Source],
    target: str | Target,
    distortion: str | Sequence[str] = "radial1",
    *,
    view: int | str | None = None,
    progress: ProgressCallback | None = None,
) -> Calibration:
    """Calibrate a camera from images of a flat target.

    The points are detected, a first camera is fitted, the points are refined in the plane of the target, free of the
    errors of perspective and lens (`fedic.calibration.detection`), and the camera is fitted again. Outliers among
    views and points are left out (`fedic.calibration._adjustment.fit`).

    Parameters
    ----------
    images : sequence of paths or ndarrays (height, width), or a pattern such as ``"views/*.tif"``
        Ten to twenty views with the target tilted about both axes, which reach the corners of the image.
    target : str or Target
        Target, such as ``"chessboard:11x7:8"`` (see `fedic.calibration.parse_target`); its unit of length becomes the
        world's.
    distortion : str or sequence of str
        Lens model: ``"none"``, ``"radial1"``, ``"radial2"``, ``"radial3"``, ``"decentering"``, ``"prism"``,
        ``"brown"`` (radial3 and decentering), or several such as ``"radial1+prism"``; for a lens of any shape
        ``"spline"`` (`fedic.SplineDistortion`) or ``"inverse-spline"`` (`fedic.InverseSplineDistortion`).
    view : int or str, optional
        Index or name of the image whose pose the camera takes; by default the first accepted.
    progress : callable, optional
        Called with the `fedic.Progress` of the stages ``"detect"`` and ``"refine"``.

    Returns
    -------
    Calibration
        The camera, its uncertainty, and the residuals of each view.

    Raises
    ------
    CameraError
        If the target or distortion is misspelt, the target is found in fewer than two images, has another number of
        points in as many images as it is found in, or the views do not determine the camera or do not fit together.

    Warns
    -----
    CalibrationWarning
        If the target has another number of points in some images, is not as given (see `Calibration.target_shape`), or
        the camera found is not plausible.
    """
    plan = parse_target(target) if isinstance(target, str) else target
    lens = parse_lens(distortion)
    sources = _sources(images)
    names = [_name(source, index) for index, source in enumerate(sources)]
    detected, refined_views = fraction_callback(progress, "detect"), fraction_callback(progress, "refine")
    observations, faults, wrong, image_size = _search(sources, names, plan, detected)
    found = [index for index in range(len(sources)) if index in observations]
    if wrong:
        _tell_wrong_count(plan, names, wrong, found)
    if len(found) < 2:
        raise CameraError(_too_few(plan, names, faults))
    seen = [observations[index] for index in found]
    first = fit_or_explain(lens if isinstance(lens, CoefficientLens) else BROWN, seen, image_size)
    for place, index in enumerate(found):
        pose = first.estimate.rotations[place], first.estimate.translations[place]
        camera = first.lens.camera(first.estimate.intrinsics, *pose)
        seen[place] = refine_points(_load(sources[index], names[index]), plan, seen[place], camera)
        refined_views((place + 1) / len(found))
    final = fit_shape(fit_or_explain(lens, seen, image_size), seen, image_size)
    return build_result(seen, found, names, faults, final, image_size, view)


def _sources(images: str | Sequence[Source]) -> list[Source]:
    if isinstance(images, str):
        matches = sorted(glob.glob(images)) if glob.has_magic(images) else [images]  # noqa: PTH207 - any pattern
        if not matches:
            raise ImageError(f"{images}: no image file matches this pattern; check the folder.")
        return list(matches)
    return list(images)


def _name(source: Source, index: int) -> str:
    return fspath(source) if isinstance(source, (str, PathLike)) else f"image {index}"


def _load(source: Source, name: str) -> Image:
    return read_image(source) if isinstance(source, (str, PathLike)) else as_image(source, name)


def _search(
    sources: list[Source], names: list[str], target: Target, report: Callable[[float], object]
) -> tuple[dict[int, Observation], dict[int, str], dict[int, str], tuple[int, int]]:
    """Return the points found by image, the reasons for the others and for wrong counts, and the size of the images."""
    observations, sizes = dict[int, Observation](), dict[int, tuple[int, int]]()
    faults, wrong = dict[int, str](), dict[int, str]()
    for index, (source, name) in enumerate(zip(sources, names, strict=True)):
        try:
            image = _load(source, name)
            sizes[index] = (image.shape[1], image.shape[0])
            observations[index] = find_target(image, target)
        except (ImageError, NotFoundError) as fault:
            faults[index] = str(fault).removeprefix(f"{name}: ")
            if isinstance(fault, WrongCountError):
                wrong[index] = faults[index]
        report((index + 1) / len(sources))
    common = Counter(sizes.values()).most_common(1)[0][0] if sizes else (0, 0)
    for index in [index for index in observations if sizes[index] != common]:
        del observations[index]
        width, height = sizes[index]
        faults[index] = f"the image is {width} x {height} px, most are {common[0]} x {common[1]}: another camera"
    return observations, faults, wrong, common


def _tell_wrong_count(target: Target, names: list[str], wrong: dict[int, str], found: list[int]) -> None:
    """Warn, or refuse if the images with another number of points are not outnumbered."""
    said = (
        f"The target {target} has another number of points in {len(wrong)} of {len(names)} images. Give the counts of "
        f"the whole pattern; the origin and the axes depend on them.{_listed(names, wrong)}"
    )
    if len(wrong) >= len(found):
        raise CameraError(said)
    warnings.warn(said, CalibrationWarning, stacklevel=levels_within_fedic())


def _too_few(target: Target, names: list[str], faults: dict[int, str]) -> str:
    count = len(names) - len(faults)
    return (
        f"The target {target} was found in {count} of {len(names)} images; a calibration needs at least 2, better 10 "
        f"to 20, from different directions.{_listed(names, faults)}"
    )


def _listed(names: list[str], faults: dict[int, str]) -> str:
    listed = list(faults.items())[:_CAUSES_SHOWN]
    causes = "".join(f"\n  {names[index]}: {fault}" for index, fault in listed)
    more = f"\n  ... and {len(faults) - len(listed)} more" if len(faults) > len(listed) else ""
    return f"{causes}{more}"
