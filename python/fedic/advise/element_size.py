"""The size of elements that a texture and a noise allow."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from fedic._core import CELL_TYPES
from fedic._internal.choices import check_choice
from fedic._internal.types import CellName, Floats, Image
from fedic.advise.advice import Advice
from fedic.advise.patches import Region, cells_along, predict_size
from fedic.advise.texture import Texture, texture_of
from fedic.errors import ImageError, OptionError
from fedic.io.images import as_image
from fedic.progress import ProgressCallback, fraction_callback

__all__ = ["SIZES", "advise_element_size"]

SIZES = (8.0, 10.0, 12.0, 16.0, 20.0, 24.0, 32.0, 40.0, 48.0, 64.0)
"""Sizes of elements that are tried, in pixels."""
_SMALLEST_REGION = 32
_FINEST_SPECKLE = 3.0
_SATURATED = 0.01
_LEAST_GRADIENT = 3.0
"""Gradient per pixel, relative to the noise, below which the noise of the image adds to the predicted texture."""


def advise_element_size(
    image: Image,
    noise: float,
    *,
    sizes: Sequence[float] = SIZES,
    cell: CellName = "quad",
    region: Region | None = None,
    displacement_target: float = 0.02,
    strain_target: float | None = None,
    progress: ProgressCallback | None = None,
    **options: Any,
) -> Advice:
    """Predict the standard deviations for elements of several sizes, and recommend the smallest that meets the targets.

    Parameters
    ----------
    image : ndarray of uint8, uint16 or float32, shape (height, width)
        The reference image.
    noise : float
        Standard deviation of the noise of one image in grey levels; `fedic.camera_noise` measures it.
    sizes : sequence of float
        Sizes of the elements, in pixels. Those of which fewer than three fit into the region along each side are left
        out.
    cell : str
        Type of the elements, a key of `fedic.CELL_TYPES`.
    region : (int, int, int, int), optional
        The part of the image that is measured: first column and row, and those after the last; all of it by default.
    displacement_target : float
        Largest standard deviation of the displacement, in pixels.
    strain_target : float, optional
        Largest standard deviation of the strains; they do not matter by default.
    progress : callable, optional
        Called with a `fedic.Progress` of the stage ``"advice"``.
    **options
        Options of `fedic.correlate`.

    Returns
    -------
    Advice
        The predictions, the texture and the recommended size.

    Raises
    ------
    OptionError
        If the noise, a size, a target, the type or the region is not possible.
    ImageError
        If the image cannot be used, is constant or is saturated everywhere.

    Notes
    -----
    The displacement is that of `Correlator.standard_deviations`, the variance of a strain ``b C b^T`` with the
    covariance of the nodes of a cell. They are predicted on up to five patches of 3 to 8 elements along each side, in
    the middle and the corners of the region, and the root mean square taken over the nodes and cells that do not touch
    the border of a patch. The scatter alone is predicted: large elements do not follow a field that varies within them,
    so that the smallest size is recommended.
    """
    checked = as_image(image, "reference")
    _check_numbers(noise, sizes, displacement_target, strain_target)
    check_choice("cell", cell, CELL_TYPES)
    whole = _checked_region(region, checked)
    left, top, right, bottom = whole
    part = checked[top:bottom, left:right]
    texture = _checked_texture(part, noise)
    fitting = [float(size) for size in sorted(sizes) if cells_along(whole, size)]
    if not fitting:
        raise OptionError(
            f"sizes: not even 3 elements of {min(sizes):g} px fit along the sides of the region of "
            f"{right - left} x {bottom - top} px; give smaller ones, or a larger region.",
            "sizes",
        )
    report = fraction_callback(progress, "advice")
    found = []
    for number, size in enumerate(fitting, start=1):
        found.append(predict_size(checked, whole, size, cell, noise, options))
        if report is not None:
            report(number / len(fitting))
    displacement, border, strain = (
        np.array([getattr(each, name) for each in found]) for name in ("inner", "border", "strain")
    )
    limit = math.nan if strain_target is None else strain_target
    recommended = _smallest(np.array(fitting), displacement, strain, displacement_target, strain_target)
    undetermined = {size: each.undetermined for size, each in zip(fitting, found, strict=True) if each.undetermined}
    return Advice(
        np.array(fitting),
        displacement,
        border,
        strain,
        recommended,
        displacement_target,
        limit,
        noise,
        cell,
        whole,
        texture,
        _doubts(texture, noise, recommended, fitting, undetermined),
    )


def _smallest(
    sizes: Floats, displacement: Floats, strain: Floats, displacement_target: float, strain_target: float | None
) -> float:
    """Return the smallest size from which on all are within the targets; NaN if the largest is not."""
    good = np.all(displacement <= displacement_target, axis=1)
    if strain_target is not None:
        good &= np.all(strain <= strain_target, axis=1)
    from_there = np.asarray(np.logical_and.accumulate(good[::-1]))[::-1]
    return float(sizes[np.argmax(from_there)]) if from_there.any() else math.nan


def _doubts(
    texture: Texture, noise: float, recommended: float, sizes: list[float], undetermined: dict[float, int]
) -> tuple[str, ...]:
    found = []
    if math.isnan(recommended):
        found.append(
            f"no size up to {sizes[-1]:g} px meets the targets: improve the contrast, take the mean of several images, "
            "or give larger targets"
        )
    width = min(texture.speckle_size)
    if math.isnan(width):
        found.append("the image has no speckle that stands out from the noise")
    elif width < _FINEST_SPECKLE:
        found.append(
            f"the speckle of {width:.1f} px is finer than 3 px: pixels do not resolve it, which biases results"
        )
    elif recommended < 2.0 * max(texture.speckle_size):
        found.append(f"elements of {recommended:g} px hold less than two speckles along a side")
    if texture.saturated_share >= _SATURATED:
        found.append(f"{texture.saturated_share:.1%} of the pixels are saturated: shorten the exposure")
    if min(texture.gradient) < _LEAST_GRADIENT * noise:
        found.append(
            f"the gradient per pixel is less than {_LEAST_GRADIENT:g} times the noise: standard deviations are "
            "predicted too small"
        )
    if undetermined:
        size = max(undetermined)
        found.append(f"elements of up to {size:g} px have nodes in places without texture, which are left out")
    return tuple(found)


def _check_numbers(noise: float, sizes: Sequence[float], displacement: float, strain: float | None) -> None:
    named = [("noise", noise), ("displacement_target", displacement), ("strain_target", strain)]
    named += [("sizes", size) for size in sizes]
    for name, value in named:
        if value is not None and not 0.0 < value < math.inf:
            raise OptionError(f"{name}={value}: give a positive number.", name)
    if not len(sizes):
        raise OptionError("sizes is empty; give at least one size in pixels.", "sizes")


def _checked_region(region: Region | None, image: Image) -> Region:
    height, width = image.shape
    if region is None:
        left, top, right, bottom = 0, 0, width, height
    else:
        left, top, right, bottom = region
    if not (0 <= left < right <= width and 0 <= top < bottom <= height):
        raise OptionError(
            f"region={region}: give the first column and row and those after the last, within the image of {width} x "
            f"{height} px.",
            "region",
        )
    if min(right - left, bottom - top) < _SMALLEST_REGION:
        raise OptionError(f"region={region}: it must have {_SMALLEST_REGION} px or more along each side.", "region")
    return left, top, right, bottom


def _checked_texture(part: Image, noise: float) -> Texture:
    if not np.isfinite(part).all():
        raise ImageError("The reference image holds NaN or infinite grey levels.")
    if part.min() == part.max():
        raise ImageError("The reference image is constant in the region: it has no texture to measure.")
    texture = texture_of(part, noise)
    if texture.saturated_share > 0.9:
        raise ImageError(
            f"{texture.saturated_share:.0%} of the pixels of the region are saturated; shorten the exposure."
        )
    return texture
