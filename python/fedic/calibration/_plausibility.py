"""Judgement of the camera and of the target that a calibration found: what cannot be right is refused."""

import warnings
from collections.abc import Mapping

from fedic._internal.warning_level import levels_within_fedic
from fedic.calibration._adjustment.start import FOCAL_RANGE
from fedic.errors import CalibrationWarning, CameraError

__all__ = ["check_plausible", "tell_shape"]

_LARGEST_MISFIT = 2.0
_LARGEST_ASPECT, _LARGE_ASPECT = 1.5, 1.02
_SIGNIFICANT = 5.0


def check_plausible(
    parameters: Mapping[str, float], deviations: Mapping[str, float], error: float, image_size: tuple[int, int]
) -> None:
    """Refuse a camera that cannot be right, and warn of one that hardly is.

    Parameters
    ----------
    parameters, deviations : dict of str to float
        Values and standard deviations.
    error : float
        Root mean square distance of the points, in pixels.
    image_size : (int, int)
        Width and height.

    Raises
    ------
    CameraError
        If the points are more than 2 px off, or fx and fy differ by more than a half.

    Warns
    -----
    CalibrationWarning
        If fx and fy differ by more than 2 %, the focal length is outside 0.2 to 100 times the longer side of the
        image, or the principal point is outside the image.
    """
    fx, fy, cx, cy = (parameters[name] for name in ("fx", "fy", "cx", "cy"))
    if error > _LARGEST_MISFIT:
        raise CameraError(
            f"The points are {error:.2g} px off (root mean square), more than {_LARGEST_MISFIT:g} px: no camera with "
            "this lens fits them. Check the kind and the counts of the target and the lens model, and that all views "
            "are from one camera with one focus."
        )
    aspect = max(fx / fy, fy / fx)
    if aspect > _LARGEST_ASPECT:
        raise CameraError(
            f"The focal lengths found, fx = {fx:.4g} and fy = {fy:.4g} px, differ by the factor {aspect:.3g}: that is "
            "no camera. Check the counts and the pitch of the target in both directions."
        )
    relative = (deviations["fx"] ** 2 / fx**2 + deviations["fy"] ** 2 / fy**2) ** 0.5
    if aspect > _LARGE_ASPECT and aspect - 1.0 > _SIGNIFICANT * relative:
        _warn(
            f"The focal lengths fx = {fx:.5g} and fy = {fy:.5g} px differ by {100 * (aspect - 1):.2g} %. If the pixels "
            "of the camera are square, the target is not as given: measure its pitch in both directions."
        )
    side = max(image_size)
    if not FOCAL_RANGE[0] * side <= fx <= FOCAL_RANGE[1] * side:
        _warn(
            f"The focal length {fx:.4g} px is {fx / side:.3g} times the longer side of the image, which few lenses "
            "have: check the counts of the target, and tilt it more."
        )
    if not (0.0 <= cx <= image_size[0] - 1 and 0.0 <= cy <= image_size[1] - 1):
        _warn(
            f"The principal point ({cx:.0f}, {cy:.0f}) px is outside the image of {image_size[0]} x {image_size[1]} "
            "px. That is right for a part of a larger image only: tilt the target more, and check that it is flat."
        )


def tell_shape(shape: Mapping[str, tuple[float, float]], half: float) -> None:
    """Warn of a target that is not as planned.

    Parameters
    ----------
    shape : dict of str to (float, float)
        Value and standard deviation of the free unknowns of the shape.
    half : float
        Half the length of the target.

    Warns
    -----
    CalibrationWarning
        With the values, and what to do.
    """
    if "stretch" in shape:
        value, deviation = shape["stretch"]
        _warn(
            f"The target is not as given: its pitch along Y (of a column) is {1 + value:.5f} ± {deviation:.5f} times "
            f"that along X (of a row), relative to the target given. The camera is fitted with this stretch, and with "
            "the pitch along X as given. Measure both pitches, and give them, such as chessboard:11x7:8x8.04."
        )
    if "skew" in shape:
        value, deviation = shape["skew"]
        _warn(
            f"The target is not right-angled: its columns lean by {1000 * value:.3f} ± {1000 * deviation:.3f} mrad. "
            "The camera is fitted with this skew; a target that is printed true is better."
        )
    bends = [name for name in shape if name.startswith("bend")]
    if bends:
        largest = max(bends, key=lambda name: abs(shape[name][0]))
        value, deviation = (half * number for number in shape[largest])
        _warn(
            f"The target is not flat: over half its length it rises by {value:.3g} ± {deviation:.2g} (in its unit of "
            "length). The camera is fitted with this bend, to second order; a flat target is better."
        )


def _warn(message: str) -> None:
    warnings.warn(message, CalibrationWarning, stacklevel=levels_within_fedic())
