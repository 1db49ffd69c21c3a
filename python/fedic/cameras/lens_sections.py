"""Lenses as sections of TOML files: ``[camera.distortion]``, one pydantic model for each lens model of `LENSES`."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, Union

from pydantic import Discriminator, Tag, create_model, field_validator

from fedic._core import LENSES, Distortion, LensModel
from fedic._internal.sections import Real, Section

__all__ = ["LENS_SECTIONS", "LensSection", "lens_table"]

_DEFAULT_MODEL = "brown"
"""The model of a section without the key ``model``."""


class _LensSection(Section):
    """``[camera.distortion]``; the keys besides ``model`` are the arguments of the lens class."""

    model: str

    def build(self) -> Distortion:
        """Create the lens."""
        return LENSES[self.model].lens(**self.model_dump(exclude={"model"}))


class _FieldSection(_LensSection):
    """A lens made of a spline field."""

    domain: tuple[Real, Real, Real, Real]
    coefficients: list[list[tuple[Real, Real]]]

    @field_validator("coefficients")
    @classmethod
    def _rectangular(cls, rows: list[list[tuple[float, float]]]) -> list[list[tuple[float, float]]]:
        if len({len(row) for row in rows}) != 1:
            raise ValueError("should have rows of equal length")
        if len(rows) < 4 or len(rows[0]) < 4:
            raise ValueError("should have at least 4 rows of 4 pairs, for one interval along each axis")
        return rows


def _section(model: LensModel) -> type[_LensSection]:
    """Return the section of a lens model: its groups of coefficients, zero by default, or a field."""
    name: Any = Literal[model.name]
    model_key = (name, model.name) if model.name == _DEFAULT_MODEL else (name, ...)
    groups: dict[str, Any] = {
        group: (tuple[(Real,) * len(coefficients)], (0.0,) * len(coefficients))  # type: ignore[misc]
        for group, coefficients in model.groups.items()
    }
    base = _LensSection if groups else _FieldSection
    return create_model(f"{model.lens.__name__}Section", __base__=base, model=model_key, **groups)


LENS_SECTIONS: Mapping[str, type[_LensSection]] = {name: _section(model) for name, model in LENSES.items()}
"""The section of each lens model, by the name of the model."""


def _model_name(value: object) -> str:
    if isinstance(value, dict):
        return str(value.get("model", _DEFAULT_MODEL))
    return str(getattr(value, "model", _DEFAULT_MODEL))


if TYPE_CHECKING:
    LensSection: TypeAlias = _LensSection
else:
    LensSection = Annotated[
        Union[tuple(Annotated[section, Tag(name)] for name, section in LENS_SECTIONS.items())],  # noqa: UP007
        Discriminator(_model_name),
    ]
    """The section of a lens of any model."""


def lens_table(lens: Distortion) -> dict[str, object]:
    """Return the keys and values of the section of a lens, for `LensSection` to read."""
    table: dict[str, object] = {} if lens.model == _DEFAULT_MODEL else {"model": lens.model}
    for key in LENS_SECTIONS[lens.model].model_fields:
        if key != "model":
            value = getattr(lens, key)
            table[key] = list(value) if isinstance(value, tuple) else value.tolist()
    return table
