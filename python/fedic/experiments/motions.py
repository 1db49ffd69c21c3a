"""Images moved by large known motions: translations, rotations and stretches about the centre of a mesh."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from fedic._core import ImageFrame, Mesh, rectangle_mesh
from fedic._internal.types import CellName, Floats, Image
from fedic.demo.scene import LEVELS, SPECKLE
from fedic.experiments.outcome import Request
from fedic.experiments.reference_images import reference_images
from fedic.synthetic import Speckle, render

__all__ = ["Motion", "Scene", "scenes"]

_WIDTH, _HEIGHT = 200.0, 240.0
"""Size of the mesh in pixels."""
_CORNER = (0.3, 0.7)
_MARGIN = 220
"""Margin around the mesh in the synthetic image, in pixels, above the largest translation."""


@dataclass(frozen=True)
class Motion:
    """A motion of the whole image.

    Attributes
    ----------
    kind : {"translation", "rotation", "stretch"}
        Kind of motion; a stretch is along the columns.
    amount : float
        Amount in pixels, degrees or percent.
    turn : float
        Angle in degrees between a translation and the direction to the centre of the image, or the columns if the mesh
        is there.
    """

    kind: str
    amount: float
    turn: float = 0.0

    @property
    def gradient(self) -> Floats:
        """Gradient of the displacement, shape (2, 2)."""
        if self.kind == "rotation":
            angle = math.radians(self.amount)
            return np.array(
                [[math.cos(angle) - 1.0, -math.sin(angle)], [math.sin(angle), math.cos(angle) - 1.0]], dtype=np.float64
            )
        return np.diag([self.amount / 100.0 if self.kind == "stretch" else 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class Scene:
    """A reference image with the position of the mesh, and its moved images.

    Attributes
    ----------
    name : str
        Name in tables and figures.
    reference : ndarray, shape (height, width)
        The image.
    corner : (float, float)
        Left and top of the mesh, in pixels.
    moved_image : callable
        Function from a displacement gradient (2, 2) about the centre of the mesh and a translation (2,) to the image.
    """

    name: str
    reference: Image
    corner: tuple[float, float]
    moved_image: Callable[[Floats, Floats], Image]

    @property
    def centre(self) -> Floats:
        """Middle of the mesh, in pixels."""
        return _middle(self.corner)

    def mesh(self, size: float, cell: CellName) -> Mesh:
        """Make a regular mesh."""
        left, top = self.corner
        return rectangle_mesh((left, top, left + _WIDTH, top + _HEIGHT), size, cell)

    def moved(self, motion: Motion) -> Image:
        """Return the image after a motion."""
        return self.moved_image(motion.gradient, self._translation(motion))

    def displacement(self, motion: Motion, points: Floats) -> Floats:
        """Return the true displacement of points (n, 2), in pixels."""
        true: Floats = (points - self.centre) @ motion.gradient.T + self._translation(motion)
        return true

    def _translation(self, motion: Motion) -> Floats:
        if motion.kind != "translation":
            return np.zeros(2)
        height, width = self.reference.shape
        inwards = np.array([(width - 1) / 2, (height - 1) / 2]) - self.centre
        angle = math.radians(motion.turn)
        if np.abs(inwards).max() > 1.0:
            angle += math.atan2(inwards[1], inwards[0])
        return motion.amount * np.array([math.cos(angle), math.sin(angle)])


def scenes(request: Request) -> list[Scene]:
    """Return the synthetic scene and, if an image is given, the real one.

    The synthetic image is rendered for each motion, in a quick run with one sample per pixel; the real one is resampled
    by Lanczos interpolation.

    Parameters
    ----------
    request : Request
        Request, with or without a real image.

    Returns
    -------
    list of Scene
        The synthetic one first.
    """
    found = [_synthetic(1 if request.quick else 2)]
    if request.image is not None:
        real = reference_images(request)[-1]
        corner = (real.left + _CORNER[0], real.top + _CORNER[1])
        found.append(Scene(real.name, real.image, corner, _resampler(real.image, corner)))
    return found


def _middle(corner: tuple[float, float]) -> Floats:
    return np.array([corner[0] + _WIDTH / 2, corner[1] + _HEIGHT / 2])


def _synthetic(supersampling: int) -> Scene:
    shape = (round(_HEIGHT) + 2 * _MARGIN, round(_WIDTH) + 2 * _MARGIN)
    corner = (_MARGIN + _CORNER[0], _MARGIN + _CORNER[1])
    centre = _middle(corner)
    texture = Speckle(SPECKLE, seed=0)

    def moved(gradient: Floats, translation: Floats) -> Image:
        def displacement(points: Floats) -> Floats:
            there: Floats = (points - centre) @ gradient.T + translation
            return there

        return render(
            texture, ImageFrame(), shape, displacement=displacement, supersampling=supersampling, levels=LEVELS
        )

    return Scene("synthetic", moved(np.zeros((2, 2)), np.zeros(2)), corner, moved)


def _resampler(image: Image, corner: tuple[float, float]) -> Callable[[Floats, Floats], Image]:
    centre = _middle(corner)

    def moved(gradient: Floats, translation: Floats) -> Image:
        linear = np.eye(2) + gradient
        affine = np.column_stack([linear, centre + translation - linear @ centre])
        height, width = image.shape
        resampled = cv2.warpAffine(
            image.astype(np.float32), affine, (width, height), flags=cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REFLECT
        )
        return np.asarray(resampled, dtype=np.float32)

    return moved
