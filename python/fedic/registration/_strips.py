"""Features as a camera sees them: sampled along their length."""

from collections.abc import Sequence

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import Image
from fedic.errors import CameraError
from fedic.registration._edges import Strip, prepare_strip
from fedic.registration._features import BoundaryFeature
from fedic.registration._pose import Placeable
from fedic.registration._sampling import sample_feature

__all__ = ["feature_strips"]

_BLOCK_PX = 12.0
_LEAST_IN_IMAGE = 0.3


def feature_strips(
    mesh: Mesh, wanted: Sequence[BoundaryFeature], image: Image, camera: Placeable, search: float
) -> list[Strip]:
    """Sample features as a camera sees them.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    wanted : sequence of BoundaryFeature
        The features.
    image : ndarray, shape (height, width)
        The image.
    camera : FrontParallel or Pinhole
        The camera.
    search : float
        Distance in pixels up to which a feature may be outside the image.

    Returns
    -------
    list of Strip
        One for each feature.

    Raises
    ------
    CameraError
        If most of a feature is outside.
    """
    height, width = image.shape
    strips = []
    for feature in wanted:
        samples = sample_feature(mesh, feature, camera, _BLOCK_PX)
        seen = camera.project(samples.points)
        inside = np.all((seen >= -search) & (seen <= np.array([width, height]) - 1.0 + search), axis=1)
        if inside.mean() < _LEAST_IN_IMAGE:
            u, v = seen.mean(axis=0)
            raise CameraError(
                f"camera: the given pose puts the feature {feature.name!r} around ({u:.0f}, {v:.0f}), outside the "
                f"image of {width} x {height} px; correct it."
            )
        strips.append(prepare_strip(feature.name, mesh, samples, camera))
    return strips
