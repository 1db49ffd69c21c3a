"""Images and options of a result, from which its correlator can be prepared again."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic import _core
from fedic._core import Mesh
from fedic._internal.types import Camera, Floats
from fedic.io.kept import KeptImage
from fedic.regularization.equilibrium_gap import Regularization, core_gap

__all__ = ["Measurement"]


@dataclass(frozen=True, eq=False)
class Measurement:
    """Images and options of a result.

    Attributes
    ----------
    reference, deformed : KeptImage
        The images.
    mesh : Mesh
        The mesh as it lies in the reference image.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    mask : ndarray of bool, or None
        Pixels of the reference image that are left out.
    regularization : {"smooth"} or EquilibriumGap
        Kind of the regularization.
    options : mapping
        Keyword arguments of the core's correlator.
    correlator : callable, or None
        Returns the correlator that measured as long as it exists, such as a weak reference; otherwise another one is
        prepared.
    first : (Mesh, ndarray of float64 of shape (n, 2)), optional
        The mesh that displacements are counted from, and the displacement from it to `mesh`, if the reference image is
        that of a later frame.
    has_lost_weights : bool
        Whether the result had robust weights that were not kept; they are found again where they are needed.
    """

    reference: KeptImage
    deformed: KeptImage
    mesh: Mesh
    camera: Camera
    mask: NDArray[np.bool_] | None
    regularization: Regularization
    options: Mapping[str, Any]
    correlator: Callable[[], _core.Correlator | None] | None = field(default=None, repr=False)
    first: tuple[Mesh, Floats] | None = field(default=None, repr=False)
    has_lost_weights: bool = False

    def residual_map(self, displacement: Floats) -> NDArray[np.float32]:
        """Return the residual at the pixels of the reference image, for a displacement."""
        deformed = self.deformed.read()
        return self._prepared().residual_map(deformed, self._since_reference(displacement))

    def covariance(self, noise: float, displacement: Floats, information: Any) -> _core.Covariance:
        """Return the covariance of the displacement for a noise of the images, near a displacement."""
        correlator, step = self._prepared(), self._since_reference(displacement)
        if self.has_lost_weights and information is None:
            information = correlator.correlate(self.deformed.read(), initial=step).information
        found = correlator.covariance(noise, step, information)
        return found if self.first is None else found.of_total(self.first[0], displacement)

    def _since_reference(self, displacement: Floats) -> Floats:
        return displacement if self.first is None else displacement - self.first[1]

    def _prepared(self) -> _core.Correlator:
        correlator = None if self.correlator is None else self.correlator()
        if correlator is None:
            gap = core_gap(self.regularization, self.mesh)
            correlator = _core.Correlator(
                self.reference.read(), self.mesh, self.camera, mask=self.mask, gap=gap, **self.options
            )
        return correlator

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "correlator": None}
