"""The structure of the sources, and the rules themselves on small examples."""

from pathlib import Path

import pytest

from structure import python_rules, rust_rules
from structure.graphs import cycles, long_files

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGE = REPOSITORY / "python" / "fedic"
CRATES = [path for path in sorted((REPOSITORY / "crates").iterdir()) if path.is_dir()]


def names(paths: list[Path]) -> list[str]:
    return [str(path.relative_to(REPOSITORY)) for path in paths]


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


def test_python_files_do_not_import_each_other_in_a_cycle() -> None:
    assert [names(cycle) for cycle in cycles(python_rules.imports(PACKAGE))] == []


def test_no_file_imports_the_whole_package() -> None:
    whole = PACKAGE / "__init__.py"
    assert [path for path, targets in python_rules.imports(PACKAGE).items() if whole in targets] == []


def test_nothing_imports_the_experiments() -> None:
    assert names(python_rules.importers(PACKAGE, "experiments")) == []


def test_private_modules_are_imported_by_their_own_package_only() -> None:
    assert [names([*pair]) for pair in python_rules.foreign_private_imports(PACKAGE)] == []


def test_no_source_file_is_longer_than_500_lines() -> None:
    folders = [REPOSITORY / name for name in ("python", "tests", "crates", "benches", "examples")]
    files = [path for folder in folders for end in ("py", "pyi", "rs") for path in folder.rglob(f"*.{end}")]
    assert {str(path.relative_to(REPOSITORY)): count for path, count in long_files(files).items()} == {}


@pytest.mark.parametrize("crate", CRATES, ids=lambda crate: crate.name)
def test_rust_files_do_not_import_each_other_in_a_cycle(crate: Path) -> None:
    assert [names(cycle) for cycle in cycles(rust_rules.imports(crate / "src"))] == []


def test_every_folder_of_the_core_has_a_header_that_says_what_it_may_import() -> None:
    source = REPOSITORY / "crates" / "fedic" / "src"
    wrong = {}
    for folder, imported in rust_rules.folder_imports(source).items():
        module = source / folder / "mod.rs"
        lines, allowed = rust_rules.header(module), rust_rules.allowed_imports(module)
        if not lines or len(lines) > rust_rules.MAX_HEADER_LINES:
            wrong[folder] = f"the header has {len(lines)} lines"
        elif allowed is None:
            wrong[folder] = "the header has no line 'May import: ...'"
        elif imported - allowed:
            wrong[folder] = f"it imports {sorted(imported - allowed)}"
    assert wrong == {}


def test_imports_inside_functions_count(tmp_path: Path) -> None:
    package = write(
        tmp_path / "pack",
        {
            "__init__.py": "",
            "a.py": "from pack.b import f\n",
            "b.py": "def f():\n    from pack import a\n    return a\n",
            "c.py": "import pack.a\n",
        },
    )
    assert cycles(python_rules.imports(package)) == [[package / "a.py", package / "b.py"]]


def test_private_modules_are_seen_from_their_own_package_and_below(tmp_path: Path) -> None:
    package = write(
        tmp_path / "pack",
        {
            "__init__.py": "",
            "inner/__init__.py": "from pack.inner._hidden import f\n",
            "inner/_hidden.py": "f = 1\n",
            "inner/deep/__init__.py": "from pack.inner import _hidden\n",
            "outer.py": "from pack.inner._hidden import f\n",
        },
    )
    found = python_rules.foreign_private_imports(package)
    assert found == [(package / "outer.py", package / "inner" / "_hidden.py")]
    assert python_rules.importers(package, "inner") == [package / "outer.py"]


def test_rust_imports_are_resolved_through_re_exports(tmp_path: Path) -> None:
    source = write(
        tmp_path / "src",
        {
            "lib.rs": "mod low;\nmod high;\nmod part;\npub use low::Low;\nuse other::Thing;\n",
            "low.rs": "use crate::{Thing, part::{Item, deep}};\npub struct Low;\n",
            "high.rs": "use crate::Low; // use crate::part::Item;\nfn f() { crate::part::Item::new(); }\n",
            "part/mod.rs": "//! Parts.\n//! May import: `low` and high.\nmod deep;\npub use deep::Item;\n",
            "part/deep.rs": "use super::super::high::g;\n#[cfg(test)]\nmod tests { use crate::low::Low; }\n",
        },
    )
    low, high, deep = source / "low.rs", source / "high.rs", source / "part" / "deep.rs"
    graph = rust_rules.imports(source)
    assert graph[low] == {deep}
    assert graph[high] == {low, deep}
    assert graph[deep] == {high}
    assert graph[source / "lib.rs"] == graph[source / "part" / "mod.rs"] == set()
    assert cycles(graph) == [sorted([low, high, deep])]
    assert rust_rules.allowed_imports(source / "part" / "mod.rs") == {"low", "high"}


def test_folders_of_a_crate_import_each_other(tmp_path: Path) -> None:
    source = write(
        tmp_path / "src",
        {
            "lib.rs": "mod one;\nmod two;\n",
            "one/mod.rs": "mod a;\n",
            "one/a.rs": "use crate::two::b::B;\n",
            "two/mod.rs": "pub mod b;\n",
            "two/b.rs": "pub struct B;\n",
        },
    )
    assert rust_rules.folder_imports(source) == {"one": {"two"}, "two": set()}
    assert rust_rules.allowed_imports(source / "one" / "mod.rs") is None
