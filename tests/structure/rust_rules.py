"""Imports between the files of a Rust crate, and the headers of its folders.

Modules declared by ``mod`` are no imports. A re-export (``pub use`` or ``use`` of a descendant) in ``lib.rs`` or a
``mod.rs`` is no import either: whoever imports the name is taken to import the file that defines it. Inline modules
under ``#[cfg(test)]`` are left out, since a unit test may use what is above the tested code.
"""

import re
from collections.abc import Iterator
from pathlib import Path

MAX_HEADER_LINES = 10
_USE = re.compile(r"\buse\s+((?:::)?[\w:{},*\s]+?)\s*;")
_PATH = re.compile(r"\b(?:crate|super|self)(?:::\w+)+")
_IGNORED = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:[^"\\]|\\.)*"', re.DOTALL)
_MAY_IMPORT = re.compile(r"May import:\s*([^.]*)\.")


def imports(source: Path) -> dict[Path, set[Path]]:
    """Return the files that each file of a crate imports, `source` being the folder of its ``lib.rs``."""
    crate = _Crate(source)
    return {path: crate.imported(path) for path in crate.files}


def header(path: Path) -> list[str]:
    """Return the lines of the documentation at the top of a file."""
    lines: list[str] = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("//!"):
            break
        lines.append(line.removeprefix("//!").strip())
    return lines


def allowed_imports(path: Path) -> set[str] | None:
    """Return the folders that the header of a ``mod.rs`` allows to import; None if it has no such line."""
    match = _MAY_IMPORT.search(" ".join(header(path)))
    if match is None:
        return None
    return {name for name in re.findall(r"\w+", match[1]) if name not in ("and", "nothing", "none")}


def folder_imports(source: Path) -> dict[str, set[str]]:
    """Return, for each folder of a crate, the other folders that its files import; its tests may import any."""
    found: dict[str, set[str]] = {folder.name: set() for folder in sorted(source.iterdir()) if folder.is_dir()}
    for path, targets in imports(source).items():
        here = path.relative_to(source).with_suffix("").parts
        if "tests" in here:
            continue
        for target in targets:
            there = target.relative_to(source).parts
            if len(here) > 1 and len(there) > 1 and here[0] != there[0]:
                found[here[0]].add(there[0])
    return found


class _Crate:
    def __init__(self, source: Path) -> None:
        self.modules = {_module(source, path): path for path in sorted(source.rglob("*.rs"))}
        self.files = {path: module for module, path in self.modules.items()}
        self._code = {path: _code(path) for path in self.files}
        self._exports = {module: self._exported(module) for module in self.modules}

    def imported(self, path: Path) -> set[Path]:
        module = self.files[path]
        code = self._code[path]
        paths = {_absolute(name, module) for name in _used(code)}
        paths |= {_absolute(match.split("::"), module) for match in _PATH.findall(_USE.sub(";", code))}
        found = set()
        for target in paths:
            if target is None or (module in self._exports and target in self._exports[module].values()):
                continue
            file = self._resolve(target)
            if file is not None and file != path:
                found.add(file)
        return found

    def _exported(self, module: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
        """Return the names that a ``lib.rs`` or ``mod.rs`` takes from its descendants, with their full paths."""
        path = self.modules[module]
        if path.name not in ("lib.rs", "mod.rs"):
            return {}
        exports = {}
        for name in _used(self._code[path]):
            target = _absolute(name if name[0] in ("crate", "self", "super") else ["self", *name], module)
            if target is not None and len(target) > len(module) and target[: len(module)] == module:
                exports[target[-1]] = target
        return exports

    def _resolve(self, target: tuple[str, ...], depth: int = 0) -> Path | None:
        """Return the file that defines a name; None for a name of another crate."""
        length = next(length for length in range(len(target), -1, -1) if target[:length] in self.modules)
        module, rest = target[:length], target[length:]
        if not rest or rest[0] == "*" or depth > 8:
            return self.modules[module]
        export = self._exports[module].get(rest[0])
        if export is not None and export[: len(module) + 1] != target[: len(module) + 1]:
            if export[len(module)] not in self._declared(module):
                return None
            return self._resolve((*export, *rest[1:]), depth + 1)
        if self._foreign(module, rest[0]):
            return None
        return self.modules[module]

    def _declared(self, module: tuple[str, ...]) -> set[str]:
        return {name[len(module)] for name in self.modules if len(name) > len(module) and name[: len(module)] == module}

    def _foreign(self, module: tuple[str, ...], name: str) -> bool:
        """Tell whether a module takes a name from another crate."""
        for used in _used(self._code[self.modules[module]]):
            if used[-1] == name and used[0] not in ("crate", "self", "super") and used[0] not in self._declared(module):
                return True
        return False


def _module(source: Path, path: Path) -> tuple[str, ...]:
    parts = path.relative_to(source).with_suffix("").parts
    return parts[:-1] if parts[-1] in ("mod", "lib") else parts


def _code(path: Path) -> str:
    """Return a file without comments, strings and the inline modules of unit tests."""
    text = path.read_text(encoding="utf-8")
    text = re.sub(
        r'//[^\n]*|/\*.*?\*/|"(?:[^"\\]|\\.)*"', lambda m: '""' if m[0][0] == '"' else "", text, flags=re.DOTALL
    )
    while (match := re.search(r"#\[cfg\(test\)\]\s*(?:#\[[^\]]*\]\s*)*mod\s+\w+\s*\{", text)) is not None:
        depth, place = 1, match.end()
        while depth:
            depth += {"{": 1, "}": -1}.get(text[place], 0)
            place += 1
        text = text[: match.start()] + text[place:]
    return text


def _used(code: str) -> Iterator[list[str]]:
    """Yield the paths of all ``use`` declarations, groups expanded; ``as`` names are dropped."""
    for tree in _USE.findall(re.sub(r"\s+as\s+\w+", "", code)):
        yield from _expanded(tree.removeprefix("::"))


def _expanded(tree: str) -> Iterator[list[str]]:
    tree = tree.strip()
    head, brace, rest = tree.partition("{")
    if not brace:
        yield [part.strip() for part in tree.split("::")]
        return
    prefix = [part.strip() for part in head.rstrip().removesuffix("::").split("::") if part.strip()]
    for item in _split(rest.rsplit("}", 1)[0]):
        for path in _expanded(item):
            yield prefix if path == ["self"] else [*prefix, *path]


def _split(group: str) -> Iterator[str]:
    depth, item = 0, ""
    for character in group:
        if character == "," and depth == 0:
            yield item
            item = ""
            continue
        depth += {"{": 1, "}": -1}.get(character, 0)
        item += character
    if item.strip():
        yield item


def _absolute(path: list[str], module: tuple[str, ...]) -> tuple[str, ...] | None:
    """Return a path from the crate root; None for a path that begins elsewhere."""
    first, *rest = path
    if first == "crate":
        return tuple(rest)
    if first == "self":
        return (*module, *rest)
    if first == "super":
        return _absolute(["crate", *module[:-1], *rest] if rest[:1] != ["super"] else rest, module[:-1])
    return None
