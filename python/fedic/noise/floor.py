"""The noise floor of a measurement, from static images measured with its mesh."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fedic._core import ImageFrame, Mesh
from fedic._internal.types import Camera, Floats, Image, StrPath
from fedic.correlation import Correlator
from fedic.errors import ConvergenceWarning, QualityWarning
from fedic.noise._pixels import checked_images
from fedic.progress import ProgressCallback
from fedic.results import StrainMeasure

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from fedic.options import CorrelationOptions

__all__ = ["NoiseFloor", "noise_floor"]

COMPONENTS = ("x", "y", "exx", "eyy", "exy")


@dataclass(frozen=True, eq=False, repr=False)
class NoiseFloor:
    """What a measurement reads where nothing moves, for the displacements ``x, y`` and the strains ``exx, eyy, exy``.

    Attributes
    ----------
    bias : ndarray of float, shape (5,)
        Mean over all nodes, or cells, and images. A motion of the specimen or the camera between the images is in it.
    std : ndarray of float, shape (5,)
        Noise floor: standard deviation over the nodes, or cells, of each image about the mean of that image, root mean
        square over the images.
    predicted : ndarray of float, shape (5,)
        Predicted from the noise of the camera (see `Correlator.covariance`): root mean square over the nodes, or cells;
        NaN if the noise was not given.
    means : ndarray of float, shape (images, 5)
        Mean of each image.
    num_images : int
        Number of images measured against the first.
    not_measured : int
        Number of nodes, over all images, that were not measured and are left out.
    num_nodes : int
        Number of nodes of the mesh that cells use.
    doubtful : int
        Number of images whose result is doubtful or did not converge.
    measure : {"green-lagrange", "hencky", "small"}
        Measure of the strains.
    unit : str
        Unit of the displacements; empty if it is not known.
    """

    bias: Floats
    std: Floats
    predicted: Floats
    means: Floats
    num_images: int
    not_measured: int
    num_nodes: int
    doubtful: int
    measure: StrainMeasure
    unit: str

    def __repr__(self) -> str:
        parts = [
            f"{name} {std:.2g} (bias {bias:.2g})"
            for name, std, bias in zip(COMPONENTS, self.std, self.bias, strict=True)
        ]
        return f"NoiseFloor({', '.join(parts)}; {self.num_images} images)"

    def summary(self) -> dict[str, Any]:
        """Return the result as JSON types.

        Returns
        -------
        dict
            ``components`` with ``bias``, ``std`` and ``predicted`` of each (None where not known), the numbers, the
            measure and the unit.
        """
        numbers = zip(COMPONENTS, self.bias, self.std, self.predicted, strict=True)
        return {
            "components": {
                name: {"bias": _finite(bias), "std": _finite(std), "predicted": _finite(predicted)}
                for name, bias, std, predicted in numbers
            },
            "num_images": self.num_images,
            "num_nodes": self.num_nodes,
            "not_measured": self.not_measured,
            "doubtful_images": self.doubtful,
            "strain_measure": self.measure,
            "unit": self.unit or None,
        }


def noise_floor(
    images: Sequence[Image | StrPath],
    mesh: Mesh,
    camera: Camera = ImageFrame(),
    *,
    measure: StrainMeasure = "green-lagrange",
    unit: str | None = None,
    progress: ProgressCallback | None = None,
    **options: "Unpack[CorrelationOptions]",
) -> NoiseFloor:
    """Measure static images with the mesh and the options of a test: bias and noise floor of each quantity.

    Parameters
    ----------
    images : sequence of ndarray of shape (height, width), or of file names
        Two or more images of the specimen at rest; the first is the reference image of the others.
    mesh : Mesh
        The mesh of the test.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera of the test.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.
    unit : str, optional
        Unit of length of the mesh.
    progress : callable, optional
        See `Correlator.correlate`.
    **options
        Options of `fedic.correlate`, among them `noise`, the standard deviation of the noise of one image in grey
        levels, which `fedic.camera_noise` measures. Without it nothing is predicted.

    Returns
    -------
    NoiseFloor
        Mean and standard deviation of each component, beside the predicted standard deviation.

    Raises
    ------
    OptionError, ImageError, MeshError, CameraError, SolveError
        As `fedic.camera_noise` and `fedic.correlate`.

    Notes
    -----
    Noise floor and bias from static images are those that the iDICs guide asks to report (*A Good Practices Guide for
    Digital Image Correlation*, 2018). The noise of the first image is common to all results: three images or more show
    its bias, the mean over the nodes, as well as two.
    """
    reference, *others = checked_images(images)
    correlator = Correlator(reference, mesh, camera, unit=unit, **options)
    with warnings.catch_warnings():
        # The number of doubtful results is part of the outcome.
        warnings.simplefilter("ignore", ConvergenceWarning)
        warnings.simplefilter("ignore", QualityWarning)
        results = [correlator.correlate(image, progress=progress) for image in others]
    fields = [(*result.displacement.T, *result.strains(measure).components.T) for result in results]
    means = np.array([[_mean(values) for values in field] for field in fields])
    variances = np.array([[_variance(values) for values in field] for field in fields])
    used = mesh.used_nodes
    predicted = np.full(len(COMPONENTS), np.nan)
    noise = options.get("noise")
    if noise is not None:
        covariance = correlator.covariance(noise)
        predicted[:2] = _rms(covariance.standard_deviations[used])
        predicted[2:] = _rms(covariance.strain_deviations("small"))
    return NoiseFloor(
        bias=means.mean(axis=0),
        std=np.sqrt(variances.mean(axis=0)),
        predicted=predicted,
        means=means,
        num_images=len(others),
        not_measured=sum(int(np.count_nonzero(used & ~result.valid_nodes)) for result in results),
        num_nodes=int(np.count_nonzero(used)),
        doubtful=sum(not result.quality.is_good for result in results),
        measure=measure,
        unit=results[0].unit,
    )


def _mean(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else np.nan


def _variance(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.var(ddof=1)) if len(known) > 1 else np.nan


def _rms(values: Floats) -> Floats:
    known = np.isfinite(values)
    counts = known.sum(axis=0)
    squares = np.where(known, values, 0.0) ** 2
    return np.sqrt(np.where(counts > 0, squares.sum(axis=0) / np.maximum(counts, 1), np.nan))


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
