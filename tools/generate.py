"""Write the files that are made from the tables of options in the extension module.

Usage: ``python tools/generate.py`` writes them; ``python tools/generate.py --check`` fails if one is out of date.
"""

import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path

from fedic._core import CORRELATION_OPTIONS, SPECIMEN_OPTIONS, OptionInfo
from fedic.options import python_default, python_doc, python_type

ROOT = Path(__file__).resolve().parents[1]
NOTICE = "Written by `make generate` from the options declared in crates/fedic/src. Do not edit."
CONFIGURATION = """\
The section `[correlation]` of a configuration file has the same keys, with two differences: `quadrature` is one of the
names below, beside a key `density`, and `None` is written `"none"`, or left out for a number. The argument
`regularization` is a section of its own there, [`[correlation.equilibrium_gap]`](regularization.md#equilibrium-gap).
"""
WIDTH = 112


def choices() -> str:
    """Return the module of the names that options take."""
    types: dict[str, str] = {}
    for info in [*CORRELATION_OPTIONS, *SPECIMEN_OPTIONS]:
        if info.kind == "quadrature":
            types["QuadratureRule"] = literal([name for name in info.choices if name != "pixel"])
        elif info.kind == "choice":
            types[type_name(info)] = literal(info.choices)
    lines = [f"{name}: TypeAlias = {types[name]}" for name in sorted(types)]
    exported = "".join(f'    "{name}",\n' for name in sorted(types))
    return (
        f'# {NOTICE}\n"""Names that options take."""\n\nfrom typing import Literal, TypeAlias\n\n'
        f"__all__ = [\n{exported}]\n\n" + "\n".join(lines) + "\n"
    )


def option_types() -> str:
    """Return the module of the types of keyword arguments."""
    tables = {"CorrelationOptions": CORRELATION_OPTIONS, "SpecimenOptions": SPECIMEN_OPTIONS}
    users = {
        "CorrelationOptions": "`fedic.correlate` and `fedic.Correlator`",
        "SpecimenOptions": "`fedic.calibrate_on_specimen`",
    }
    names = sorted({type_name(info) for table in tables.values() for info in table if info.kind == "choice"})
    exported = ", ".join(f'"{name}"' for name in tables)
    text = (
        f'# {NOTICE}\n"""Types of the options."""\n\nfrom typing import TypedDict\n\n'
        f"from fedic._internal.option_choices import {', '.join(names)}\n"
        "from fedic.quadrature import Quadrature\n\n"
        f"__all__ = [{exported}]\n"
    )
    for name, table in tables.items():
        text += f'\n\nclass {name}(TypedDict, total=False):\n    """Options of {users[name]}."""\n\n'
        text += "".join(field(info) for info in table)
    return text


def field(info: OptionInfo) -> str:
    """Return one key of a typed dictionary with its documentation."""
    kinds = {"flag": "bool", "integer": "int", "number": "float", "quadrature": "Quadrature"}
    hint = kinds.get(info.kind) or type_name(info)
    if info.optional:
        hint += " | None"
    doc = textwrap.wrap(f"{python_doc(info)} Default: {shown_default(info)}.", WIDTH, break_on_hyphens=False)
    end = '"""' if len(doc) == 1 else '\n    """'
    return f'    {info.name}: {hint}\n    """' + "\n    ".join(doc) + end + "\n"


def page() -> str:
    """Return the page of the documentation."""
    text = f"<!-- {NOTICE} -->\n# Options\n"
    for title, table, users in [
        ("Correlation", CORRELATION_OPTIONS, "Keyword arguments of `fedic.correlate` and `fedic.Correlator`"),
        ("Specimen calibration", SPECIMEN_OPTIONS, "Keyword arguments of `fedic.calibrate_on_specimen`"),
    ]:
        text += f"\n## {title}\n\n{users}.\n"
        if table is CORRELATION_OPTIONS:
            text += CONFIGURATION
        text += "\n| option | values | default | description |\n| --- | --- | --- | --- |\n"
        for info in table:
            doc = python_doc(info).replace("``", "`").replace("|", "\\|")
            text += f"| `{info.name}` | {shown_values(info)} | `{shown_default(info)}` | {doc} |\n"
    return text


def shown_values(info: OptionInfo) -> str:
    """Return the values that an option takes, for a cell of a table."""
    if info.kind == "quadrature":
        return f"`MeshQuadrature` or `PixelQuadrature`; {', '.join(info.choices)}"
    if info.kind in ("choice", "flag"):
        return f"`{python_type(info).strip('{}')}`" if info.kind == "flag" else ", ".join(map(quoted, info.choices))
    return info.expected + (" or `None`" if info.optional else "")


def quoted(name: str) -> str:
    """Return the name of a choice as Python spells it."""
    return "`None`" if name == "none" else f'`"{name}"`'


def shown_default(info: OptionInfo) -> str:
    """Return the default value of an option as Python spells it."""
    default = python_default(info)
    return f'"{default}"' if isinstance(default, str) else repr(default)


def type_name(info: OptionInfo) -> str:
    """Return the name of the type of a choice."""
    return info.name.title().replace("_", "")


def literal(names: Sequence[str]) -> str:
    """Return the type of some names."""
    listed = ", ".join(f'"{name}"' for name in names if name != "none")
    return f"Literal[{listed}]" + (" | None" if "none" in names else "")


FILES = {
    "python/fedic/_internal/option_choices.py": choices,
    "python/fedic/_internal/option_types.py": option_types,
    "docs/options.md": page,
}


def main() -> int:
    """Write or check every file."""
    outdated = [name for name, make in FILES.items() if not is_current(ROOT / name, make())]
    if "--check" in sys.argv[1:]:
        for name in outdated:
            sys.stderr.write(f"{name} is out of date: run `make generate` and commit it\n")
        return len(outdated)
    for name in outdated:
        (ROOT / name).write_text(FILES[name](), encoding="utf-8")
    return 0


def is_current(path: Path, text: str) -> bool:
    """Return whether a file holds the text."""
    return path.is_file() and path.read_text(encoding="utf-8") == text


if __name__ == "__main__":
    sys.exit(main())
