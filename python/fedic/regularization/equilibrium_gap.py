"""Regularization by the equilibrium gap of linear elasticity."""

from numbers import Real
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh, PlaneStress
from fedic.errors import OptionError
from fedic.regularization.edges import Edges, Given, checked_edges, edge_nodes, with_middle_nodes

__all__ = ["EquilibriumGap", "Regularization", "core_gap"]


class EquilibriumGap:
    """Mechanical regularization: the internal forces of linear elasticity are small where no load acts.

    Fields in equilibrium are left alone, however steep they are, and what is not, such as noise, is lowered: a shear
    wave of ``regularization_length`` pixels keeps half of its amplitude. No load acts at nodes inside the mesh and at
    free edges. Loaded edges are not regularized: their nodes keep their noise.

    By default any edge may be loaded. Name the free ones with `free`, or the loaded ones with `loaded`: all others are
    free then, the edges of holes and both sides of cracks included. A free edge that is loaded in truth is measured
    wrong; a loaded one that is not named as free is only noisier.

    Parameters
    ----------
    nu : float
        Poisson's ratio of an isotropic material in plane stress, greater than -1 and at most 0.5. Inside the mesh it
        matters little; at free edges it sets the ratio of the strains.
    free : str, array_like of int, or list of these, optional
        Edges without load: names of sets of the mesh, or nodes of its boundary.
    loaded : str, array_like of int, or list of these, optional
        Edges that may be loaded, if all others are free. ``[]`` for none.

    Raises
    ------
    OptionError
        If `nu` is out of its range, both `free` and `loaded` are given, or they are no edges.

    Notes
    -----
    See docs/regularization.md. The forces are those of small strains, in axes that turn with the mean rotation of the
    mesh: rotations of any size are left alone.

    Examples
    --------
    >>> import fedic
    >>> fedic.EquilibriumGap(0.33, loaded=["top", "bottom"])
    EquilibriumGap(nu=0.33, loaded=['top', 'bottom'])
    >>> fedic.EquilibriumGap.orthotropic(140e3, 10e3, 0.3, 5e3, angle=0.5)
    EquilibriumGap.orthotropic(E1=140000.0, E2=10000.0, nu12=0.3, G12=5000.0, angle=0.5)
    """

    _moduli: dict[str, float]
    _edges: dict[str, Given]

    def __init__(self, nu: float = 0.3, *, free: Edges | None = None, loaded: Edges | None = None) -> None:
        self._set({"nu": nu}, free, loaded)

    @classmethod
    def orthotropic(
        cls,
        E1: float,  # noqa: N803
        E2: float,  # noqa: N803
        nu12: float,
        G12: float,  # noqa: N803
        *,
        angle: float = 0.0,
        free: Edges | None = None,
        loaded: Edges | None = None,
    ) -> "EquilibriumGap":
        """Return the gap of an orthotropic material in plane stress.

        Parameters
        ----------
        E1, E2 : float
            Young's moduli along the axes 1 and 2 of the material, in any unit.
        nu12 : float
            Poisson's ratio: minus the strain along axis 2 over that along axis 1, under a stress along axis 1. Its
            square is less than ``E1 / E2``.
        G12 : float
            Shear modulus, in the same unit.
        angle : float
            Angle from ``x`` to axis 1, in radians, in the frame of the mesh.
        free, loaded : str, array_like of int, or list of these, optional
            Edges; see `EquilibriumGap`.

        Returns
        -------
        EquilibriumGap
            The regularization.

        Raises
        ------
        OptionError
            If the moduli are not those of a stable material, or as `EquilibriumGap`.
        """
        gap = cls.__new__(cls)
        gap._set({"E1": E1, "E2": E2, "nu12": nu12, "G12": G12, "angle": angle}, free, loaded)
        return gap

    def _set(self, moduli: dict[str, float], free: Edges | None, loaded: Edges | None) -> None:
        self._moduli = {name: _number(name, value) for name, value in moduli.items()}
        self.law()
        if free is not None and loaded is not None:
            raise OptionError("loaded must be left out where free edges are named: all others may be loaded", "loaded")
        given = {"free": free, "loaded": loaded}
        self._edges = {name: checked_edges(edges, name) for name, edges in given.items() if edges is not None}

    @property
    def moduli(self) -> dict[str, float]:
        """Moduli by name: ``nu``, or ``E1, E2, nu12, G12, angle``."""
        return dict(self._moduli)

    @property
    def edges(self) -> dict[str, Given]:
        """Edges by ``"free"`` or ``"loaded"``, as names of sets and groups of nodes; empty if none are named."""
        return dict(self._edges)

    def law(self) -> PlaneStress:
        """Return the law of the material as the core takes it.

        Returns
        -------
        PlaneStress
            The law.
        """
        if "nu" in self._moduli:
            return PlaneStress.isotropic(*self._moduli.values())
        return PlaneStress.orthotropic(*self._moduli.values())

    def free_nodes(self, mesh: Mesh) -> NDArray[np.int64]:
        """Find the nodes of the free edges of a mesh.

        Parameters
        ----------
        mesh : Mesh
            The mesh.

        Returns
        -------
        ndarray of int
            The nodes, ascending.

        Raises
        ------
        OptionError
            If the mesh has no such set or node, or a node is not at its boundary.
        """
        if "free" in self._edges:
            return edge_nodes(self._edges["free"], mesh, "free")
        if "loaded" not in self._edges:
            return np.empty(0, dtype=np.int64)
        free = mesh.boundary_nodes
        free[with_middle_nodes(edge_nodes(self._edges["loaded"], mesh, "loaded"), mesh)] = False
        return np.flatnonzero(free)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, EquilibriumGap):
            return NotImplemented
        return self._moduli == other._moduli and self._edges == other._edges

    def __hash__(self) -> int:
        return hash((tuple(self._moduli.items()), tuple(self._edges.items())))

    def __repr__(self) -> str:
        entries = [f"{name}={value!r}" for name, value in self._moduli.items()]
        for name, edges in self._edges.items():
            shown = [each if isinstance(each, str) else f"{len(each)} nodes" for each in edges]
            entries.append(f"{name}={shown!r}")
        return f"EquilibriumGap{'' if 'nu' in self._moduli else '.orthotropic'}({', '.join(entries)})"


Regularization: TypeAlias = Literal["smooth"] | EquilibriumGap


def core_gap(regularization: Regularization, mesh: Mesh) -> tuple[PlaneStress, NDArray[np.int64]] | None:
    """Return the argument ``gap`` of the core's correlator.

    Raises
    ------
    OptionError
        If it is no regularization, or its edges are not those of the mesh.
    """
    if isinstance(regularization, EquilibriumGap):
        return regularization.law(), regularization.free_nodes(mesh)
    if isinstance(regularization, str) and regularization == "smooth":
        return None
    raise OptionError(
        f'regularization must be "smooth" or a fedic.EquilibriumGap, got {regularization!r:.80}', "regularization"
    )


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise OptionError(f"{name} must be a number, got {value!r:.80}", name)
    return float(value)
