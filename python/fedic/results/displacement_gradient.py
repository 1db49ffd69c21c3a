"""Displacement gradients, and the derivative of strains with respect to them."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.results.strains import StrainMeasure

__all__ = ["displacement_gradients", "strain_derivative"]

_STEP = 1e-6
"""Step of the central differences of the Hencky strain."""


def displacement_gradients(mesh: Mesh, displacement: Floats, at: Literal["cells"] | ArrayLike = "cells") -> Floats:
    """Return the displacement gradient at the centres of the cells or at points.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    displacement : ndarray of float, shape (n, 2)
        Displacement of the nodes.
    at : "cells" or array_like of shape (m, 2)
        Centres of the cells, or points.

    Returns
    -------
    ndarray of float, shape (m, 4)
        ``du/dx, du/dy, dv/dx, dv/dy``.
    """
    own = mesh.strains(displacement, "small", at).components
    # The small strain of the displacement turned by a right angle holds the other two derivatives.
    turned = mesh.strains(np.column_stack([displacement[:, 1], -displacement[:, 0]]), "small", at).components
    return np.column_stack([own[:, 0], -turned[:, 1], turned[:, 0], own[:, 1]])


def strain_derivative(gradients: Floats, measure: StrainMeasure) -> Floats:
    """Return the derivative of ``exx, eyy, exy`` with respect to the displacement gradient.

    Parameters
    ----------
    gradients : ndarray of float, shape (m, 4)
        ``du/dx, du/dy, dv/dx, dv/dy``.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.

    Returns
    -------
    ndarray of float, shape (m, 3, 4)
        The derivatives.
    """
    derivative = np.zeros((len(gradients), 3, 4))
    if measure == "small":
        derivative[:] = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.5, 0.5, 0.0]])
    elif measure == "green-lagrange":
        ux, uy, vx, vy = gradients.T
        derivative[:, 0, 0], derivative[:, 0, 2] = 1 + ux, vx
        derivative[:, 1, 1], derivative[:, 1, 3] = uy, 1 + vy
        derivative[:, 2] = 0.5 * np.column_stack([uy, 1 + ux, 1 + vy, vx])
    else:
        for k in range(4):
            step = _STEP * np.eye(4)[k]
            derivative[:, :, k] = (_hencky(gradients + step) - _hencky(gradients - step)) / (2 * _STEP)
    return derivative


def _hencky(gradients: Floats) -> Floats:
    """Return ``ln(F^T F) / 2``, (m, 3)."""
    ux, uy, vx, vy = gradients.T
    cxx, cyy, cxy = (1 + ux) ** 2 + vx**2, uy**2 + (1 + vy) ** 2, (1 + ux) * uy + vx * (1 + vy)
    mean, radius = 0.5 * (cxx + cyy), np.hypot(0.5 * (cxx - cyy), cxy)
    with np.errstate(invalid="ignore", divide="ignore"):
        high, low = 0.5 * np.log(mean + radius), 0.5 * np.log(mean - radius)
        # ln(C)/2 = a I + b C in the plane; b has a limit where both principal stretches are equal.
        slope = np.where(radius > 1e-9 * mean, (high - low) / (2 * radius), 0.5 / mean)
    offset = 0.5 * (high + low) - slope * mean
    return np.column_stack([offset + slope * cxx, offset + slope * cyy, slope * cxy])
