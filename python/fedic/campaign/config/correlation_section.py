"""The section ``[correlation]`` of a configuration file, made from the core's table of options."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args

from pydantic import Field, create_model, model_validator

from fedic._core import CORRELATION_OPTIONS, OptionInfo
from fedic._internal.sections import Section
from fedic.campaign.config.equilibrium_gap_section import EquilibriumGapSection
from fedic.quadrature import MeshQuadrature, PixelQuadrature
from fedic.starts.initial import Start

__all__ = ["CorrelationSection"]


class _Base(Section):
    @model_validator(mode="after")
    def _density_of_a_mesh_quadrature(self) -> "_Base":
        if getattr(self, "quadrature", None) == "pixel" and "density" in self.model_fields_set:
            raise ValueError('density should be left out with quadrature = "pixel", which has no density')
        return self

    @model_validator(mode="after")
    def _length_of_an_equilibrium_gap(self) -> "_Base":
        if getattr(self, "equilibrium_gap", None) is not None and getattr(self, "regularization_length", None) is None:
            raise ValueError("regularization_length should be given with an equilibrium_gap: the wave that it halves")
        return self

    def options(self) -> dict[str, Any]:
        """Return the keyword arguments of `fedic.Correlator`."""
        options: dict[str, Any] = {
            name: None if value == "none" else value for name, value in self.model_dump().items()
        }
        rule, density = options["quadrature"], options.pop("density")
        gap = options.pop("equilibrium_gap")
        if gap is not None:
            options["regularization"] = EquilibriumGapSection(**gap).build()
        options["quadrature"] = PixelQuadrature() if rule == "pixel" else MeshQuadrature(density, rule)
        return options


def _fields() -> dict[str, tuple[Any, Any]]:
    """Return the type and the default of every key: a quadrature is a name beside a density."""
    fields: dict[str, tuple[Any, Any]] = {}
    for info in CORRELATION_OPTIONS:
        fields[info.name] = _field(info)
        if info.kind == "quadrature":
            fields["density"] = _numbers(info), MeshQuadrature().density
    return fields | {
        "initial": (Literal[get_args(Start)], "auto"),
        "equilibrium_gap": (EquilibriumGapSection | None, None),
    }


def _field(info: OptionInfo) -> tuple[Any, Any]:
    """Return the type and the default of the key of an option."""
    if info.choices:
        return Literal[tuple(info.choices)], info.default[0] if isinstance(info.default, tuple) else info.default
    if info.kind == "flag":
        return Annotated[bool, Field(strict=True)], info.default
    hint = _numbers(info)
    return hint | None if info.optional else hint, info.default


def _numbers(info: OptionInfo) -> Any:
    """Return the type of the numbers in the range of an option."""
    bounds: dict[str, Any] = {}
    if info.minimum is not None:
        minimum, excluded = info.minimum
        bounds["gt" if excluded else "ge"] = minimum
    if info.maximum is not None:
        bounds["le"] = info.maximum
    if info.kind == "integer":
        bounds = {name: int(bound) for name, bound in bounds.items()}
        return Annotated[int, Field(strict=True, **bounds)]
    return Annotated[float, Field(strict=True, allow_inf_nan=False, **bounds)]


if TYPE_CHECKING:
    CorrelationSection = _Base
else:
    CorrelationSection = create_model(
        "CorrelationSection",
        __base__=_Base,
        __module__=__name__,
        __doc__="``[correlation]``: the options of `fedic.correlate`.",
        **_fields(),
    )
