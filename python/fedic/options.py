"""Options of a measurement: their types, signatures and documentation, all made from the tables of the core.

An option is declared in ``crates/fedic/src/options``. ``make generate`` writes `fedic._internal.option_types` and
``docs/options.md`` from the same tables.
"""

import difflib
import inspect
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from fedic._core import OptionInfo
from fedic._internal.option_types import CorrelationOptions, SpecimenOptions
from fedic.errors import OptionError
from fedic.quadrature import MeshQuadrature, PixelQuadrature

__all__ = ["CorrelationOptions", "SpecimenOptions", "core_options", "with_options"]

_Documented = TypeVar("_Documented", bound=Callable[..., Any])
_PLACE = "{options}"
_WIDTH = 100


def with_options(table: Sequence[OptionInfo]) -> Callable[[_Documented], _Documented]:
    """Give a function or class that takes ``**options`` the signature and the documentation of those options.

    Parameters
    ----------
    table : sequence of OptionInfo
        The options. Their documentation replaces ``{options}`` in the docstring.

    Returns
    -------
    callable
        The decorator.
    """

    def decorate(function: _Documented) -> _Documented:
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        added = [
            inspect.Parameter(info.name, inspect.Parameter.KEYWORD_ONLY, default=python_default(info)) for info in table
        ]
        function.__signature__ = signature.replace(parameters=[*own, *added])  # type: ignore[attr-defined]
        if function.__doc__ is not None:
            text = "\n".join(_entry(info) for info in table)
            indent = next(line for line in function.__doc__.splitlines() if _PLACE in line).removesuffix(_PLACE)
            function.__doc__ = function.__doc__.replace(indent + _PLACE, textwrap.indent(text, indent))
        return function

    return decorate


def core_options(options: Mapping[str, Any], table: Sequence[OptionInfo], others: Iterable[str] = ()) -> dict[str, Any]:
    """Check the names of options, and write their values as the core takes them.

    Parameters
    ----------
    options : mapping of str to object
        The options given.
    table : sequence of OptionInfo
        The options that exist.
    others : iterable of str
        Other keyword arguments of the function, to be suggested for a name that does not exist.

    Returns
    -------
    dict
        The keyword arguments of the core.

    Raises
    ------
    OptionError
        If an option does not exist, or the quadrature is not one.
    """
    known = {info.name: info for info in table}
    for name in options:
        if name not in known:
            raise _unknown(name, [*known, *others])
    return {
        name: _core_quadrature(value) if known[name].kind == "quadrature" else value for name, value in options.items()
    }


def python_default(info: OptionInfo) -> object:
    """Return the default value of an option as Python spells it."""
    if info.kind == "quadrature":
        return MeshQuadrature()
    return None if info.default == "none" else info.default


def python_type(info: OptionInfo) -> str:
    """Return the type of an option for a docstring."""
    if info.kind == "quadrature":
        return "MeshQuadrature or PixelQuadrature"
    if info.kind == "choice":
        names = ", ".join(f'"{name}"' for name in info.choices if name != "none")
        return f"{{{names}}}" + (" or None" if "none" in info.choices else "")
    return {"flag": "bool", "integer": "int", "number": "float"}[info.kind] + (" or None" if info.optional else "")


def python_doc(info: OptionInfo) -> str:
    """Return the documentation of an option on one line, with the names of choices as Python spells them."""
    text = " ".join(info.doc.split())
    for name in info.choices:
        text = text.replace(f"`{name}`", "``None``" if name == "none" else f'``"{name}"``')
    return text


def _entry(info: OptionInfo) -> str:
    default = python_default(info)
    shown = f'"{default}"' if isinstance(default, str) else repr(default)
    body = textwrap.indent(textwrap.fill(python_doc(info), _WIDTH, break_on_hyphens=False), "    ")
    return f"{info.name} : {python_type(info)}, default {shown}\n{body}"


def _core_quadrature(quadrature: object) -> tuple[str, float]:
    if isinstance(quadrature, MeshQuadrature):
        return quadrature.rule, quadrature.density
    if isinstance(quadrature, PixelQuadrature):
        return "pixel", 1.0
    raise OptionError(
        f"quadrature must be a fedic.MeshQuadrature or a fedic.PixelQuadrature, got {quadrature!r}", "quadrature"
    )


def _unknown(name: str, known: Sequence[str]) -> OptionError:
    nearest = difflib.get_close_matches(name, known, n=2, cutoff=0.55)
    help_text = f"did you mean {' or '.join(nearest)}?" if nearest else f"the options are {', '.join(known)}."
    return OptionError(f"there is no option {name!r}; {help_text}", name)
