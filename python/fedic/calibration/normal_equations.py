"""Normal equations of a calibration: intrinsic parameters shared by all views, and one pose per view.

The poses, coupled to the intrinsic parameters alone, are eliminated (Schur complement), which leaves a system of the
size of the intrinsic parameters.
"""

import numpy as np

from fedic._types import Floats

__all__ = ["NormalEquations"]


class NormalEquations:
    """The normal matrix and right-hand side, by blocks.

    Parameters
    ----------
    products : ndarray, shape (n, p + 6, p + 6)
        For each view the product of its derivatives, those of the p intrinsic parameters first.
    gradients : ndarray, shape (n, p + 6)
        Products of derivatives and residuals.
    size : int
        p.
    """

    def __init__(self, products: Floats, gradients: Floats, size: int) -> None:
        shared = products[:, :size, :size].sum(axis=0)
        poses = products[:, size:, size:]
        tiny = np.finfo(float).tiny
        self._scale = np.sqrt(np.maximum(np.diag(shared), tiny))
        self._pose_scales = np.sqrt(np.maximum(np.diagonal(poses, axis1=1, axis2=2), tiny))
        self._shared = shared / np.outer(self._scale, self._scale)
        self._poses = poses / (self._pose_scales[:, :, np.newaxis] * self._pose_scales[:, np.newaxis, :])
        across = products[:, size:, :size]
        self._across = across / (self._pose_scales[:, :, np.newaxis] * self._scale)
        self._gradient = gradients[:, :size].sum(axis=0) / self._scale
        self._pose_gradients = gradients[:, size:] / self._pose_scales

    def step(self, damping: float) -> tuple[Floats, float]:
        """Return the step of Levenberg-Marquardt, and the squared length of it in the undamped normal matrix.

        Parameters
        ----------
        damping : float
            Added to the diagonal of the scaled matrix, whose entries are one.

        Returns
        -------
        ndarray, shape (p + 6 n,)
            Intrinsic parameters, then the pose of each view.
        float
            The squared length.
        """
        size, count = len(self._gradient), len(self._poses)
        shared = self._shared + damping * np.eye(size)
        eliminated = np.linalg.solve(
            self._poses + damping * np.eye(6),
            np.concatenate([self._across, self._pose_gradients[:, :, np.newaxis]], axis=2),
        )
        reduced = shared - np.einsum("vij,vik->jk", self._across, eliminated[:, :, :size])
        wanted = self._gradient - np.einsum("vij,vi->j", self._across, eliminated[:, :, size])
        own = np.linalg.solve(reduced, wanted)
        poses = eliminated[:, :, size] - eliminated[:, :, :size] @ own
        length = own @ self._shared @ own + 2.0 * np.einsum("vi,vij,j", poses, self._across, own)
        length += np.einsum("vi,vij,vj", poses, self._poses, poses)
        step = np.concatenate([own / self._scale, (poses / self._pose_scales).reshape(6 * count)])
        return step, float(length)

    @property
    def condition(self) -> float:
        """Condition number of what the poses leave of the scaled matrix; infinite if it is singular."""
        try:
            eliminated = np.linalg.solve(self._poses, self._across)
        except np.linalg.LinAlgError:
            return np.inf
        reduced = self._shared - np.einsum("vij,vik->jk", self._across, eliminated)
        values = np.linalg.eigvalsh(reduced)
        return float(values[-1] / values[0]) if values[0] > 0.0 else np.inf

    def inverse(self) -> Floats:
        """Return the inverse of the whole matrix, shape (p + 6 n, p + 6 n)."""
        size, count = len(self._gradient), len(self._poses)
        eliminated = np.linalg.solve(self._poses, self._across)
        reduced = self._shared - np.einsum("vij,vik->jk", self._across, eliminated)
        own = np.linalg.inv(reduced)
        stacked = eliminated.reshape(6 * count, size)
        whole = np.block([[own, -own @ stacked.T], [-stacked @ own, stacked @ own @ stacked.T]])
        for view, pose in enumerate(np.linalg.inv(self._poses)):
            place = slice(size + 6 * view, size + 6 * (view + 1))
            whole[place, place] += pose
        scale = np.concatenate([self._scale, self._pose_scales.ravel()])
        inverse: Floats = whole / np.outer(scale, scale)
        return inverse
