"""Textures, noise floor and theory of the experiments on the scene with a lens."""

from functools import lru_cache

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.demo.scene import ImagePair, Scene

__all__ = ["ROUNDING", "SCENE", "SENSOR", "ignored_distortion", "rounding_floor", "textures"]

ROUNDING = 1.0 / np.sqrt(12.0)
"""Standard deviation of the rounding to whole grey levels."""
SENSOR = (340, 240, 1160, 860)
"""Part of the paper's sensor around the mesh in both images."""
SCENE = Scene(sensor=SENSOR)
"""The paper's scene, of which only that part is rendered."""


def ignored_distortion(scene: Scene, mesh: Mesh) -> Floats:
    """Compute the displacement error of a measurement in pixels: the change of the distortion along the motion.

    Parameters
    ----------
    scene : Scene
        The scene.
    mesh : Mesh
        The mesh in pixels.

    Returns
    -------
    ndarray of float, shape (n, 2)
        Motion of each node in the image minus the motion without distortion, in pixels.
    """
    plane = scene.camera.unproject(mesh.points)
    moved: Floats = scene.camera.project(plane + np.array([*scene.motion, 0.0]))
    return moved - mesh.points - scene.pixel_motion


def rounding_floor(scene: Scene, pair: ImagePair) -> Floats:
    """Estimate the standard error, by rounding alone, of one translation measured over the whole mesh.

    Parameters
    ----------
    scene : Scene
        The scene.
    pair : ImagePair
        Its images in 8 bits.

    Returns
    -------
    ndarray of float, shape (2,)
        Standard error along ``u`` and ``v`` in pixels: a lower bound for the error of any mean over the nodes.
    """
    left, top, right, bottom = np.rint(scene.window).astype(int)
    along_v, along_u = np.gradient(pair.reference[top:bottom, left:right].astype(np.float64))
    slopes = np.stack([along_u.ravel(), along_v.ravel()])
    floor: Floats = np.sqrt(2.0 * ROUNDING**2 * np.diag(np.linalg.inv(slopes @ slopes.T)))
    return floor


@lru_cache(maxsize=8)
def _texture(seed: int) -> ImagePair:
    return SCENE.pair(seed)


def textures(count: int) -> list[ImagePair]:
    """Return pairs of the paper's scene; each is rendered once per process.

    Parameters
    ----------
    count : int
        Number of textures.

    Returns
    -------
    list of ImagePair
        Images of 16 bits.
    """
    return [_texture(seed) for seed in range(count)]
