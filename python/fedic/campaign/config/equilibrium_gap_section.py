"""The section ``[correlation.equilibrium_gap]`` of a configuration file."""

from typing import Annotated, Any

from pydantic import Field, model_validator

from fedic._internal.sections import Real, Section
from fedic.errors import OptionError
from fedic.regularization import EquilibriumGap

__all__ = ["EquilibriumGapSection"]

_ORTHOTROPIC = ("E1", "E2", "nu12", "G12")
_Names = Annotated[list[str], Field(strict=True)]


class EquilibriumGapSection(Section):
    """``[correlation.equilibrium_gap]``: the material, and the edges as names of sets of the mesh."""

    nu: Real | None = None
    E1: Real | None = None
    E2: Real | None = None
    nu12: Real | None = None
    G12: Real | None = None
    angle: Real | None = None
    free: _Names | None = None
    loaded: _Names | None = None

    @model_validator(mode="after")
    def _is_a_material(self) -> "EquilibriumGapSection":
        given = [name for name in _ORTHOTROPIC if getattr(self, name) is not None]
        if (given or self.angle is not None) and (len(given) < len(_ORTHOTROPIC) or self.nu is not None):
            raise ValueError("should have either nu, or E1, E2, nu12, G12 and perhaps angle")
        try:
            self.build()
        except OptionError as error:
            raise ValueError(f"should be a material and its edges: {error}") from error
        return self

    def build(self) -> EquilibriumGap:
        """Return the regularization."""
        given: dict[str, Any] = {name: value for name, value in self.model_dump().items() if value is not None}
        return EquilibriumGap.orthotropic(**given) if "E1" in given else EquilibriumGap(**given)
