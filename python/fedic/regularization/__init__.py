"""Mechanical regularization of the displacement."""

from fedic.regularization.equilibrium_gap import EquilibriumGap, Regularization

__all__ = ["EquilibriumGap", "Regularization"]
