"""The noise of a camera as measured on static images."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._internal.types import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["CameraNoise"]


@dataclass(frozen=True, eq=False, repr=False)
class CameraNoise:
    """The noise of a camera, in grey levels, measured on images of one scene at rest.

    Attributes
    ----------
    std : float
        Standard deviation of the noise of one image: root mean square over the pixels used, the rounding of the grey
        levels included, without what a change of the light or a small motion adds. NaN if every pair of images moved
        too much. This is the `noise` that `fedic.correlate` and `Correlator.standard_deviations` take.
    standard_error : float
        Standard error of `std`.
    raw_std : float
        Standard deviation as read from the differences of the images when only a gain and an offset of each image are
        removed: too high if the images moved.
    slope, intercept : float
        Line through the variance of the noise against the grey level: the variance is ``intercept + slope grey``. The
        slope is the inverse of the electrons per grey level. NaN if the grey levels do not span a line.
    slope_error, intercept_error : float
        Standard errors of the line.
    greys, variances, variance_errors : ndarray, shape (bins,)
        Mean grey level, variance and its standard error of each of 20 bins of as many pixels.
    shift, shift_error : ndarray, shape (num_images - 1, 2)
        Translation ``(u, v)`` in pixels from each image to the next, and its standard error; NaN without texture.
    motion : ndarray, shape (num_images - 1,)
        Root mean square motion over the image from each image to the next, in pixels, that of rotations and strains
        included.
    excess : ndarray, shape (num_images - 1,)
        How much too high the noise of each pair reads because of the motion: 0.13 for 13 %. NaN where the motion is too
        large to tell.
    moved : bool
        Whether some image moved so much that the noise reads more than 1 % too high.
    refused_pairs : int
        Number of pairs that moved too much to be used.
    correlation : (float, float)
        Correlation of the noise of neighbouring pixels along u and v, zero for white noise.
    num_images : int
        Number of images.
    used_share : float
        Share of the pixels used: not saturated, nor at black.
    saturated_share : float
        Largest share of saturated pixels of an image.
    doubts : tuple of str
        What is doubtful, in sentences.
    """

    std: float
    standard_error: float
    raw_std: float
    slope: float
    intercept: float
    slope_error: float
    intercept_error: float
    greys: Floats
    variances: Floats
    variance_errors: Floats
    shift: Floats
    shift_error: Floats
    motion: Floats
    excess: Floats
    moved: bool
    refused_pairs: int
    correlation: tuple[float, float]
    num_images: int
    used_share: float
    saturated_share: float
    doubts: tuple[str, ...] = ()

    def __repr__(self) -> str:
        line = "" if math.isnan(self.slope) else f", variance {self.intercept:.3g} + {self.slope:.3g} grey"
        state = "" if not self.doubts else "; " + "; ".join(self.doubts)
        return (
            f"CameraNoise({self.std:.4g} +- {self.standard_error:.2g} grey levels from {self.num_images} images"
            f"{line}{state})"
        )

    def at(self, grey: ArrayLike) -> Floats | NDArray[np.float64]:
        """Return the standard deviation of the noise at a grey level.

        Parameters
        ----------
        grey : float or array_like
            Grey levels.

        Returns
        -------
        ndarray of float
            From the line; NaN where the line is not known or below zero.
        """
        variance = self.intercept + self.slope * np.asarray(grey, dtype=np.float64)
        return np.sqrt(np.where(variance >= 0.0, variance, np.nan))

    def summary(self) -> dict[str, Any]:
        """Return the result as JSON types.

        Returns
        -------
        dict
            The attributes by name, None where one is NaN, and ``unit``.
        """
        found: dict[str, Any] = {"unit": "grey levels; shifts and motion in pixels"}
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            found[name] = _json(value.tolist() if isinstance(value, np.ndarray) else value)
        return found

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the variance against the grey level, with the line through it.

        Parameters
        ----------
        axes : matplotlib Axes, optional
            Where to draw; those of a new figure by default.

        Returns
        -------
        matplotlib Axes
            The axes; ``axes.figure.savefig`` writes the figure.
        """
        from fedic.plotting.noise import draw_grey_line

        title = f"noise {self.std:.3g} grey levels (rms), {self.num_images} images"
        if self.doubts:
            title += f"\nDOUBTFUL: {self.doubts[0].split(':')[0]}"
        line = (self.intercept, self.slope)
        return draw_grey_line(self.greys, self.variances, self.variance_errors, line, title=title, axes=axes)


def _json(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return [_json(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
