"""The two images as the estimators use them: normalised, reduced, with the region of the mesh."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Camera, Floats, Image

__all__ = ["Level", "StartImages"]

_RANGE = (0.5, 99.5)
_SAMPLES = 200_000
_FRACTION_BITS = 4


@dataclass(frozen=True, eq=False)
class Level:
    """The images reduced by one factor.

    Attributes
    ----------
    reference, deformed : ndarray of float32, shape (height, width)
        Grey levels, most of them between 0 and 1.
    region : ndarray of bool, shape (height, width)
        Pixels of the reference image inside the mesh.
    reduction : ndarray, shape (3, 3)
        Map from pixels of the images as given to those of this level.
    """

    reference: NDArray[np.float32]
    deformed: NDArray[np.float32]
    region: NDArray[np.bool_]
    reduction: Floats

    def reduced(self, motion: Floats) -> Floats:
        """Return a motion of the images as given in the pixels of this level."""
        matrix: Floats = self.reduction @ motion @ np.linalg.inv(self.reduction)
        return matrix

    def enlarged(self, motion: Floats) -> Floats:
        """Return a motion of this level in the pixels of the images as given."""
        matrix: Floats = np.linalg.inv(self.reduction) @ motion @ self.reduction
        return matrix

    def bounds(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the first and last pixel (u, v) of the region."""
        return _bounds(self.region)


@dataclass(frozen=True, eq=False)
class StartImages:
    """Two images, the mesh's nodes and its region in the reference image.

    Attributes
    ----------
    reference, deformed : ndarray of float32, shape (height, width)
        Finite grey levels, scaled to between 0 and 1 by their percentiles.
    nodes : ndarray of float64, shape (n, 2)
        The mesh's nodes in the reference image, in pixels; NaN where a node has no place.
    region : ndarray of bool, shape (height, width)
        Pixels of the reference image inside the mesh.
    """

    reference: NDArray[np.float32]
    deformed: NDArray[np.float32]
    nodes: Floats
    region: NDArray[np.bool_]
    _levels: dict[tuple[int, int], Level] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, reference: Image, deformed: Image, mesh: Mesh, camera: Camera) -> "StartImages":
        """Prepare two images of the same shape and a mesh.

        Parameters
        ----------
        reference, deformed : ndarray of uint8, uint16, float32 or float64, shape (height, width)
            The two images; grey levels that are not finite are replaced by the median.
        mesh : Mesh
            The mesh.
        camera : camera
            Projects the mesh to the reference image.

        Returns
        -------
        StartImages
            The images; `region` is empty if the mesh lies outside the reference image.
        """
        nodes = np.full((mesh.num_nodes, 2), np.nan)
        used = mesh.used_nodes
        nodes[used] = camera.project(mesh.points[used])
        region = _region(mesh, nodes, reference.shape)
        return cls(_normalised(reference, region), _normalised(deformed, None), nodes, region)

    def bounds(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the first and last pixel (u, v) of the region."""
        return _bounds(self.region)

    def corners(self) -> Floats:
        """Return the corners of the box around the region, shape (4, 2)."""
        low, high = self.bounds()
        return np.array([low, [high[0], low[1]], high, [low[0], high[1]]], dtype=np.float64)

    def level(self, factor: float) -> Level:
        """Return the images reduced by a factor of at least 1, made once."""
        import cv2

        height, width = self.reference.shape
        size = (max(1, round(width / max(factor, 1.0))), max(1, round(height / max(factor, 1.0))))
        if size not in self._levels:
            horizontal, vertical = size[0] / width, size[1] / height
            reduction = np.array(
                [
                    [horizontal, 0.0, 0.5 * horizontal - 0.5],
                    [0.0, vertical, 0.5 * vertical - 0.5],
                    [0.0, 0.0, 1.0],
                ]
            )
            reference, deformed, share = (
                np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.float32)
                for image in (self.reference, self.deformed, self.region.astype(np.float32))
            )
            self._levels[size] = Level(reference, deformed, share >= 0.5, reduction)
        return self._levels[size]

    def level_of_side(self, side: float) -> Level:
        """Return the images reduced so that their larger side is at most `side` pixels."""
        return self.level(max(self.reference.shape) / side)

    def has_texture(self) -> bool:
        """Tell whether the mesh covers some pixels, and they and the deformed image are not flat."""
        return bool(self.region.any()) and float(np.ptp(self.reference[self.region])) > 0.0 < float(
            np.ptp(self.deformed)
        )


def _bounds(region: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    rows, columns = (np.flatnonzero(region.any(axis=axis)) for axis in (1, 0))
    return np.array([columns[0], rows[0]]), np.array([columns[-1], rows[-1]])


def _normalised(image: Image, region: NDArray[np.bool_] | None) -> NDArray[np.float32]:
    """Return grey levels scaled so that most of those in the region lie between 0 and 1, limited to near this range."""
    grey = np.asarray(image)
    inside = grey[region] if region is not None and region.any() else grey.ravel()
    inside = inside[:: max(1, inside.size // _SAMPLES)].astype(np.float64)
    inside = inside[np.isfinite(inside)]
    if inside.size == 0:
        return np.zeros(grey.shape, dtype=np.float32)
    low, middle, high = np.percentile(inside, (_RANGE[0], 50.0, _RANGE[1]))
    if not high > low:
        low, high = float(inside.min()), float(inside.max())
    if not high > low:
        return np.zeros(grey.shape, dtype=np.float32)
    if grey.dtype.kind == "f":
        grey = np.where(np.isfinite(grey), grey, middle)
    grey = grey.astype(np.float64 if grey.dtype.kind == "f" else np.float32)
    return np.asarray(np.clip((grey - low) / (high - low), -0.5, 1.5), dtype=np.float32)


def _region(mesh: Mesh, nodes: Floats, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return the pixels inside the cells."""
    import cv2

    mask = np.zeros(shape[:2], dtype=np.uint8)
    limit = 4.0 * max(shape)
    for outlines in mesh.outlines():
        loops = np.clip(nodes[outlines], -limit, limit)
        loops = loops[np.isfinite(loops).all(axis=(1, 2))]
        fixed = np.rint(loops * 2**_FRACTION_BITS).astype(np.int32)
        cv2.fillPoly(mask, list(fixed), (1,), shift=_FRACTION_BITS)
    region: NDArray[np.bool_] = mask.astype(bool)
    return region
