"""Images and options of a result, from which its correlator can be prepared again."""

import weakref
from collections.abc import Mapping
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
        The mesh.
    camera : ImageFrame, FrontParallel or Pinhole
        The camera.
    mask : ndarray of bool, or None
        Pixels of the reference image that are left out.
    regularization : {"smooth"} or EquilibriumGap
        Kind of the regularization.
    options : mapping
        Keyword arguments of the core's correlator.
    correlator : weakref to Correlator, or None
        The correlator that measured, used as long as it exists; otherwise another one is prepared.
    """

    reference: KeptImage
    deformed: KeptImage
    mesh: Mesh
    camera: Camera
    mask: NDArray[np.bool_] | None
    regularization: Regularization
    options: Mapping[str, Any]
    correlator: "weakref.ref[_core.Correlator] | None" = field(default=None, repr=False)

    def residual_map(self, displacement: Floats) -> NDArray[np.float32]:
        """Return the residual at the pixels of the reference image, for a displacement."""
        deformed = self.deformed.read()
        return self._prepared().residual_map(deformed, displacement)

    def covariance(self, noise: float, displacement: Floats, information: Any) -> _core.Covariance:
        """Return the covariance of the displacement for a noise of the images, near a displacement."""
        return self._prepared().covariance(noise, displacement, information)

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
