"""Every public name has a docstring in the NumPy style with its parameters and return value."""

import inspect
import itertools
from types import ModuleType
from typing import Any

import pytest

import fedic

MODULES = ("", "calibration", "probes", "registration", "synthetic")


def public_objects() -> dict[str, Any]:
    """Return the public functions, classes and methods of the package by their qualified name."""
    found: dict[str, Any] = {}
    for name in MODULES:
        module = getattr(fedic, name) if name else fedic
        for each in module.__all__:
            item = getattr(module, each)
            if isinstance(item, ModuleType) or not callable(item):
                continue
            key = ".".join(filter(None, ["fedic", name, each]))
            found[key] = item
            if inspect.isclass(item) and not issubclass(item, BaseException):
                fields = {*getattr(item, "__dataclass_fields__", ()), *getattr(item, "_fields", ())}
                for attribute in vars(item).keys() - fields:
                    if not attribute.startswith("_"):
                        found[f"{key}.{attribute}"] = getattr(item, attribute)
    return dict(sorted(found.items()))


OBJECTS = public_objects()


def sections(item: Any) -> set[str]:
    lines = (inspect.getdoc(item) or "").splitlines()
    return {title for title, rule in itertools.pairwise(lines) if rule and set(rule) == {"-"}}


@pytest.mark.parametrize("name", OBJECTS)
def test_every_public_name_has_a_docstring(name: str) -> None:
    summary = (inspect.getdoc(OBJECTS[name]) or "").partition("\n\n")[0]
    assert summary.endswith((".", ":"))


@pytest.mark.parametrize("name", [name for name, item in OBJECTS.items() if inspect.isroutine(item)])
def test_functions_document_parameters_and_returns(name: str) -> None:
    signature = inspect.signature(OBJECTS[name])
    parameters = [each for each in signature.parameters if each not in ("self", "cls")]
    documented = inspect.getdoc(OBJECTS[name]) or ""
    if parameters:
        assert "Parameters" in sections(OBJECTS[name])
    assert [each for each in parameters if each not in documented] == []
    if signature.return_annotation not in (None, "None", inspect.Signature.empty):
        assert sections(OBJECTS[name]) & {"Returns", "Yields"}
