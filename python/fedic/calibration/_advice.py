"""Advice on how to improve a calibration."""

from itertools import islice

import numpy as np

from fedic._internal.determinacy import correlated_pairs, insignificant
from fedic._internal.types import Floats

__all__ = ["correlation_advice", "coverage_advice", "parameter_advice", "tilt_advice", "view_advice"]

_FEW_VIEWS = 6
_SMALL_TILT = 10.0
_FAR_CORNER = 0.15
_POOR_FOCAL = 0.005
_POOR_CENTRE = 0.01
_LARGE_ERROR = 0.5


def view_advice(accepted: int, error: float) -> list[str]:
    """Judge the number of views and the reprojection error in pixels."""
    advice = []
    if accepted < _FEW_VIEWS:
        advice.append(f"Only {accepted} views are used: take 10 to 20.")
    if error > _LARGE_ERROR:
        advice.append(
            f"The reprojection error is {error:.2g} px: the images are blurred, the target is not flat, or the lens "
            "needs a model with more parameters."
        )
    return advice


def tilt_advice(rotations: Floats) -> list[str]:
    """Judge the directions from which the target is seen.

    Parameters
    ----------
    rotations : ndarray, shape (n, 3, 3)
        Rotations from the target to the camera.

    Returns
    -------
    list of str
        Sentences.
    """
    normals = rotations[:, :, 2]
    widest = float(np.degrees(np.arccos(np.clip(normals @ normals.T, -1.0, 1.0))).max())
    if widest < _SMALL_TILT:
        return [
            f"All views are parallel to within {widest:.1f} degrees: focal length and distance cannot be told apart; "
            "tilt the target by 20 to 40 degrees, about both axes."
        ]
    _, _, axes = np.linalg.svd(normals - normals.mean(axis=0))
    extents = np.degrees(np.ptp(normals @ axes.T, axis=0))
    if extents[1] < _SMALL_TILT:
        return [
            f"The target is tilted about one axis only (by {extents[0]:.0f} degrees, about the other by "
            f"{extents[1]:.0f}): tilt it about the other too."
        ]
    return []


def coverage_advice(pixels: Floats, image_size: tuple[int, int]) -> list[str]:
    """Name the corners of the image without points nearby.

    Parameters
    ----------
    pixels : ndarray, shape (n, 2)
        All points used.
    image_size : (int, int)
        Width and height.

    Returns
    -------
    list of str
        Sentences.
    """
    width, height = image_size
    corners = {
        "upper left": (0, 0),
        "upper right": (width - 1, 0),
        "lower left": (0, height - 1),
        "lower right": (width - 1, height - 1),
    }
    diagonal = float(np.hypot(width, height))
    far = {name: float(np.linalg.norm(pixels - corner, axis=1).min()) for name, corner in corners.items()}
    bare = [f"{name} ({distance:.0f} px)" for name, distance in far.items() if distance > _FAR_CORNER * diagonal]
    if not bare:
        return []
    noun = "corner" if len(bare) == 1 else "corners"
    return [
        f"No point of the target is near the {noun} {', '.join(bare)} of the image: the lens is extrapolated there; "
        "add views with the target in it."
    ]


def parameter_advice(
    parameters: dict[str, float], deviations: dict[str, float], image_size: tuple[int, int]
) -> list[str]:
    """Name the parameters that the views hardly determine.

    Parameters
    ----------
    parameters, deviations : dict of str to float
        Values and standard deviations.
    image_size : (int, int)
        Width and height.

    Returns
    -------
    list of str
        Sentences.
    """
    advice = []
    relative = max(deviations[name] / parameters[name] for name in ("fx", "fy"))
    if relative > _POOR_FOCAL:
        advice.append(
            f"The focal length is known to {100 * relative:.1f} % only: tilt the target more, and fill the image with "
            "it."
        )
    centre = max(deviations["cx"], deviations["cy"])
    if centre > _POOR_CENTRE * max(image_size):
        advice.append(
            f"The principal point is known to {centre:.1f} px only: tilt the target more, and turn it in its plane."
        )
    weak = [
        f"{name} = {parameters[name]:.2g} ± {deviations[name]:.2g}"
        for name in insignificant(parameters, deviations)
        if name not in ("fx", "fy", "cx", "cy")
    ]
    if weak:
        advice.append(
            f"Not significantly different from zero: {', '.join(weak)}. Use a simpler lens model, or add views near "
            "the borders."
        )
    return advice


def correlation_advice(names: tuple[str, ...], covariance: Floats) -> list[str]:
    """Name the most correlated pair of parameters.

    Parameters
    ----------
    names : tuple of str
        The parameters.
    covariance : ndarray, shape (p + ..., p + ...)
        Covariance that begins with these parameters.

    Returns
    -------
    list of str
        Sentences.
    """
    own = covariance[: len(names), : len(names)]
    return [
        f"{first} and {second} can hardly be told apart (correlation {abs(correlation):.4f}) and the least squares are "
        "far from linear, so that their standard deviations are too small: choose a lens model without one of them, or "
        "tilt the target more."
        for first, second, correlation in islice(correlated_pairs(names, own), 1)
    ]
