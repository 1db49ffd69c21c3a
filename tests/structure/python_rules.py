"""Imports between the files of a Python package, also those inside functions and for type checking only."""

import ast
from collections.abc import Iterator
from pathlib import Path


def imports(package: Path) -> dict[Path, set[Path]]:
    """Return the files that each file of a package imports.

    ``from package import name`` is an import of the module ``name`` if there is one, else of ``__init__.py``.
    """
    graph: dict[Path, set[Path]] = {}
    for path in sorted(package.rglob("*.py")):
        found = {_file(package, name) for name in _imported(path, package)}
        graph[path] = {target for target in found if target is not None and target != path}
    return graph


def foreign_private_imports(package: Path) -> list[tuple[Path, Path]]:
    """Return the imports of a module or package with a leading underscore from outside the package that holds it."""
    found = []
    for path, targets in imports(package).items():
        for target in targets:
            parts = target.relative_to(package).with_suffix("").parts
            private = next((place for place, part in enumerate(parts) if _is_private(part)), None)
            if private is not None and not path.is_relative_to(package.joinpath(*parts[:private])):
                found.append((path, target))
    return sorted(found)


def importers(package: Path, subpackage: str) -> list[Path]:
    """Return the files outside a subpackage that import from it."""
    inner = package / subpackage
    return [
        path
        for path, targets in imports(package).items()
        if not path.is_relative_to(inner) and any(target.is_relative_to(inner) for target in targets)
    ]


def _is_private(part: str) -> bool:
    return part.startswith("_") and not part.startswith("__")


def _imported(path: Path, package: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: relative import"
            module = node.module or ""
            for alias in node.names:
                name = f"{module}.{alias.name}"
                yield name if _file(package, name) is not None else module


def _file(package: Path, name: str) -> Path | None:
    """Return the file of a module of the package; None for other modules and names."""
    first, *rest = name.split(".")
    if first != package.name:
        return None
    if not rest:
        return package / "__init__.py"
    module = package.joinpath(*rest)
    candidates = (module.with_suffix(".py"), module / "__init__.py", module.with_suffix(".pyi"))
    return next((path for path in candidates if path.is_file()), None)
