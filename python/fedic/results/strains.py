"""Strains at cells, nodes or points."""

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from fedic._internal.types import Floats

__all__ = ["StrainAxes", "StrainMeasure", "Strains", "strain_fields"]

StrainMeasure: TypeAlias = Literal["green-lagrange", "hencky", "small"]
StrainAxes: TypeAlias = float | Literal["cylindrical"]
"""Angle in radians from the local axes, or ``"cylindrical"``."""


def strain_fields(measure: StrainMeasure, *, deviation: bool = False) -> tuple[str, str, str]:
    """Return the names of the components of the strain in files.

    Parameters
    ----------
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.
    deviation : bool
        Whether to name their standard deviations.

    Returns
    -------
    tuple of str
        ``green_lagrange_strain_xx``, ``..._yy``, ``..._xy``, or ``green_lagrange_strain_std_xx`` and so on.
    """
    name = f"{measure.replace('-', '_')}_strain_{'std_' if deviation else ''}"
    return f"{name}xx", f"{name}yy", f"{name}xy"


@dataclass(frozen=True, eq=False, repr=False)
class Strains:
    """Strains at a number of positions, along two axes of the surface.

    ``H`` is the displacement gradient along the surface and ``F = I + H``; all measures refer to the reference
    configuration. Tension is positive, and the shear is the tensor component, half the engineering shear.

    ====================  ========================  ===========================  ============================
    measure               definition                bar stretched from 1 to s    rigid rotation by an angle a
    ====================  ========================  ===========================  ============================
    ``"green-lagrange"``  ``(F^T F - I) / 2``       ``(s^2 - 1) / 2``            0
    ``"hencky"``          ``ln(F^T F) / 2 = ln U``  ``ln s``                     0
    ``"small"``           ``(H + H^T) / 2``         ``s - 1``                    ``cos a - 1``
    ====================  ========================  ===========================  ============================

    NumPy functions take the object as the array of its `components`.

    Attributes
    ----------
    measure : {"green-lagrange", "hencky", "small"}
        The strain measure.
    components : ndarray of float, shape (m, 3)
        ``exx, eyy, exy`` along `axes`; NaN where the strain is not known.
    positions : ndarray of float, shape (m, d)
        The positions, of as many coordinates ``d`` as the points of the mesh.
    axes : ndarray of float, shape (m, 2, d)
        Unit vectors of the axes ``x`` and ``y`` of the components at each position, in the mesh's frame. With
        cylindrical axes the first is radial and the second circumferential.
    """

    measure: StrainMeasure
    components: Floats
    positions: Floats
    axes: Floats

    def __repr__(self) -> str:
        return f"Strains({self.measure}, {len(self)} positions)"

    def __len__(self) -> int:
        return len(self.components)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats:
        if copy:
            return np.array(self.components, dtype=dtype)
        return np.asarray(self.components, dtype=dtype)

    def __getitem__(self, index: Any) -> Any:
        return self.components[index]

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of `components`, (m, 3)."""
        return self.components.shape

    @property
    def exx(self) -> Floats:
        """Normal strains along the first axis, (m,)."""
        return self.components[:, 0]

    @property
    def eyy(self) -> Floats:
        """Normal strains along the second axis, (m,)."""
        return self.components[:, 1]

    @property
    def exy(self) -> Floats:
        """Shear strains, (m,): the tensor component, half the engineering shear."""
        return self.components[:, 2]

    @property
    def values(self) -> Floats:
        """Strain tensors along `axes`, (m, 2, 2)."""
        return self.components[:, [[0, 2], [2, 1]]]

    @property
    def principal(self) -> Floats:
        """Principal strains ``e1 >= e2``, (m, 2)."""
        mean = 0.5 * (self.exx + self.eyy)
        radius = np.hypot(0.5 * (self.exx - self.eyy), self.exy)
        return np.column_stack([mean + radius, mean - radius])

    @property
    def directions(self) -> Floats:
        """Unit vectors of the principal directions in the mesh's frame, (m, 2, d).

        ``directions[i, 0]`` belongs to ``e1``, ``directions[i, 1]`` to ``e2``; their sign has no meaning. If the
        principal strains are equal, every direction is principal, and `axes` are returned.
        """
        angle = 0.5 * np.arctan2(2.0 * self.exy, self.exx - self.eyy)
        cos, sin = np.cos(angle)[:, np.newaxis], np.sin(angle)[:, np.newaxis]
        first, second = self.axes[:, 0], self.axes[:, 1]
        return np.stack([cos * first + sin * second, cos * second - sin * first], axis=1)

    @property
    def von_mises(self) -> Floats:
        """Von Mises equivalent strains of an incompressible material, (m,).

        ``sqrt(2/3 e:e)`` with the strain ``-(e1 + e2)`` through the thickness, so
        ``2/sqrt(3) sqrt(e1^2 + e1 e2 + e2^2)``: the axial strain of a bar in tension. It is the equivalent strain of
        plasticity (J. Lemaitre and J.-L. Chaboche, *Mechanics of Solid Materials*, 1990). At large strains it is meant
        for the Hencky strain, the only one whose trace is zero if the volume is constant.
        """
        exx, eyy, exy = self.components.T
        return np.asarray(2.0 / np.sqrt(3.0) * np.sqrt(exx**2 + exx * eyy + eyy**2 + exy**2))

    def mean(self, axis: int | None = None, dtype: Any = None, out: Any = None) -> Any:
        """Return the mean of the components, as `numpy.ndarray.mean`.

        Parameters
        ----------
        axis, dtype, out
            As those of `numpy.ndarray.mean`; ``axis=0`` is the mean over the positions.

        Returns
        -------
        ndarray or float
            NaN if a strain is NaN; use `numpy.nanmean` to leave those out.
        """
        return self.components.mean(axis, dtype, out)
