"""Normal equations of a calibration: intrinsic parameters shared by all views, and one pose per view.

The poses, coupled to the intrinsic parameters alone, are eliminated (Schur complement), which leaves a system of the
size of the intrinsic parameters.
"""

import numpy as np

from fedic._internal.types import Floats

__all__ = ["NormalEquations"]

_TINY = np.finfo(float).tiny


class NormalEquations:
    """Normal matrix, right-hand side and cost, by blocks; empty until views are added.

    Parameters
    ----------
    size : int
        Number p of intrinsic parameters.
    penalty : ndarray, shape (p, p), optional
        Matrix of a quadratic form of the intrinsic parameters that is part of the cost.
    values : ndarray, shape (p,), optional
        Values of the intrinsic parameters, needed with a penalty.

    Attributes
    ----------
    cost : float
        Sum of the squared residuals and the penalty.
    """

    def __init__(self, size: int, penalty: Floats | None = None, values: Floats | None = None) -> None:
        self._shared, self._gradient, self.cost = np.zeros((size, size)), np.zeros(size), 0.0
        if penalty is not None and values is not None:
            force = penalty @ values
            self._shared, self._gradient, self.cost = penalty.copy(), -force, float(values @ force)
        self._residuals: list[Floats] = []
        self._rows: list[Floats] = []
        self._of_poses: list[Floats] = []
        self._across: list[Floats] = []
        self._pose_gradients: list[Floats] = []

    def add(self, rows: Floats, residuals: Floats) -> None:
        """Add a view.

        Parameters
        ----------
        rows : ndarray, shape (m, p + 6)
            Derivatives of its m projected coordinates with respect to the intrinsic parameters, then to the pose.
        residuals : ndarray, shape (m,)
            Measured minus projected coordinates.
        """
        own, pose = self._split(rows)
        self._rows.append(rows)
        self._residuals.append(residuals)
        self._shared += own.T @ own
        self._gradient += own.T @ residuals
        self._of_poses.append(pose.T @ pose)
        self._across.append(pose.T @ own)
        self._pose_gradients.append(pose.T @ residuals)
        self.cost += float(residuals @ residuals)

    @property
    def residuals(self) -> Floats:
        """Weighted residuals of all views, shape (m,)."""
        return np.concatenate(self._residuals)

    def solve(self, damping: float, target: Floats | None = None) -> tuple[Floats, float]:
        """Solve for a step, see `fedic._internal.least_squares.Equations.solve`.

        The step holds the intrinsic parameters, then the pose of each view: shape (p + 6 n,).
        """
        if target is None:
            return self._solve(damping, self._gradient, np.array(self._pose_gradients))
        parts = np.split(target, np.cumsum([len(rows) for rows in self._rows])[:-1])
        own, poses = np.zeros_like(self._gradient), []
        for rows, values in zip(self._rows, parts, strict=True):
            of_own, of_pose = self._split(rows)
            own += of_own.T @ values
            poses.append(of_pose.T @ values)
        return self._solve(damping, own, np.array(poses))

    def apply(self, step: Floats) -> Floats:
        """Return the change of the projected coordinates along a step, to first order, shape (m,)."""
        own, poses = step[: len(self._gradient)], step[len(self._gradient) :].reshape(-1, 6)
        views = zip(self._rows, poses, strict=True)
        return np.concatenate([rows @ np.concatenate([own, pose]) for rows, pose in views])

    def _split(self, rows: Floats) -> tuple[Floats, Floats]:
        return rows[:, : len(self._gradient)], rows[:, len(self._gradient) :]

    def _solve(self, damping: float, gradient: Floats, pose_gradients: Floats) -> tuple[Floats, float]:
        scale, pose_scales, shared, poses, across = self._scaled()
        gradient, pose_gradients = gradient / scale, pose_gradients / pose_scales
        size = len(scale)
        sources = np.concatenate([across, pose_gradients[:, :, np.newaxis]], axis=2)
        eliminated = np.linalg.solve(poses + damping * np.eye(6), sources)
        stacked, solved = across.reshape(-1, size), eliminated.reshape(-1, size + 1)
        reduced = shared + damping * np.eye(size) - stacked.T @ solved[:, :size]
        own = np.linalg.solve(reduced, gradient - stacked.T @ solved[:, size])
        moves = (solved[:, size] - solved[:, :size] @ own).reshape(-1, 6)
        length = own @ shared @ own + 2.0 * moves.ravel() @ (stacked @ own)
        length += np.einsum("vi,vij,vj", moves, poses, moves)
        return np.concatenate([own / scale, (moves / pose_scales).ravel()]), float(length)

    def eliminated(self) -> tuple[Floats, Floats, float]:
        """Return matrix (p, p), right-hand side (p,) and cost of the intrinsic parameters with the poses eliminated."""
        poses, across, gradients = map(np.array, (self._of_poses, self._across, self._pose_gradients))
        size = len(self._gradient)
        solved = np.linalg.solve(poses, np.concatenate([across, gradients[:, :, np.newaxis]], axis=2))
        stacked, solved = across.reshape(-1, size), solved.reshape(-1, size + 1)
        rest = self.cost - float(gradients.ravel() @ solved[:, size])
        return self._shared - stacked.T @ solved[:, :size], self._gradient - stacked.T @ solved[:, size], rest

    @property
    def condition(self) -> float:
        """Condition number of the scaled matrix with the poses eliminated; infinite if it is singular."""
        scale, _, _, _, _ = self._scaled()
        try:
            reduced, _, _ = self.eliminated()
        except np.linalg.LinAlgError:
            return np.inf
        values = np.linalg.eigvalsh(reduced / np.outer(scale, scale))
        return float(values[-1] / values[0]) if values[0] > 0.0 else np.inf

    def stiffened(self, penalty: Floats) -> float:
        """Return the effective number of intrinsic parameters that are determined by a penalty in the matrix."""
        reduced, _, _ = self.eliminated()
        return float(np.trace(np.linalg.solve(reduced, penalty)))

    def inverse(self) -> Floats:
        """Return the inverse of the whole matrix, shape (p + 6 n, p + 6 n)."""
        scale, pose_scales, shared, poses, across = self._scaled()
        size, count = len(scale), len(poses)
        stacked = np.linalg.solve(poses, across).reshape(6 * count, size)
        own = np.linalg.inv(shared - across.reshape(6 * count, size).T @ stacked)
        whole = np.block([[own, -own @ stacked.T], [-stacked @ own, stacked @ own @ stacked.T]])
        for view, pose in enumerate(np.linalg.inv(poses)):
            place = slice(size + 6 * view, size + 6 * (view + 1))
            whole[place, place] += pose
        scales = np.concatenate([scale, pose_scales.ravel()])
        inverse: Floats = whole / np.outer(scales, scales)
        return inverse

    def _scaled(self) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return the scales of the intrinsic parameters and of the poses, and the blocks scaled to a unit diagonal."""
        poses, across = np.array(self._of_poses), np.array(self._across)
        scale = np.sqrt(np.maximum(np.diag(self._shared), _TINY))
        pose_scales = np.sqrt(np.maximum(np.diagonal(poses, axis1=1, axis2=2), _TINY))
        shared = self._shared / np.outer(scale, scale)
        across = across / (pose_scales[:, :, np.newaxis] * scale)
        return (
            scale,
            pose_scales,
            shared,
            poses / (pose_scales[:, :, np.newaxis] * pose_scales[:, np.newaxis, :]),
            across,
        )
