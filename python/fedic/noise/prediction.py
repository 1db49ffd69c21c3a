"""Standard deviations of the strains of cells, predicted from the noise of the images."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fedic import _core
from fedic._core import CORRELATION_OPTIONS, Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.io.images import as_image
from fedic.options import core_options

__all__ = ["strain_deviations"]


def strain_deviations(
    image: Image, mesh: Mesh, camera: Camera, noise: float, options: Mapping[str, Any] | None = None
) -> Floats:
    """Predict the standard deviation of the strains at the centres of the cells.

    Parameters
    ----------
    image : ndarray, shape (height, width)
        The reference image.
    mesh : Mesh
        The mesh.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    noise : float
        Standard deviation of the noise of one image, in grey levels.
    options : mapping, optional
        Options of `fedic.correlate`; those of the start do not matter.

    Returns
    -------
    ndarray of float64, shape (num_cells, 3)
        Of ``exx``, ``eyy`` and the tensor component ``exy`` of small strains; NaN in cells with a node that no point
        determines. See `fedic.Covariance.strains`.

    Raises
    ------
    OptionError, ImageError, MeshError, CameraError, SolveError
        As `fedic.Correlator`.
    """
    names = {info.name for info in CORRELATION_OPTIONS}
    given = {name: value for name, value in (options or {}).items() if name in names}
    arguments = core_options(given, CORRELATION_OPTIONS)
    correlator = _core.Correlator(as_image(image, "reference"), mesh, camera, **arguments)
    deviations: Floats = np.sqrt(np.diagonal(correlator.covariance(noise).cell_strains("small"), axis1=1, axis2=2))
    return deviations
