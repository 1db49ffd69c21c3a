"""Write the tables of the files that fedic reads, from small files that are written, read and compared.

Usage: ``python tools/format_tables.py`` writes ``docs/formats.md``; with ``--check`` it fails if that is out of date.
Each module of ``tools/formats`` gives one table: ``TITLE``, ``COLUMNS`` and ``rows(folder)``.
"""

import importlib.util
import sys
import tempfile
import textwrap
import warnings
from collections.abc import Iterator, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "formats.md"
SUBJECTS = ("images", "meshes", "finite_element_programs", "cameras")
LIBRARIES = (
    "numpy",
    "opencv-python-headless",
    "tifffile",
    "imagecodecs",
    "meshio",
    "gmsh",
    "h5py",
    "netCDF4",
    "scipy",
    "pyyaml",
    "defusedxml",
)
HEAD = """\
# Formats

Written by `python tools/format_tables.py`. Do not edit. Each line is a small file that was written, read by fedic and
compared with what it holds; the same files are read by the tests. Rules and reasons: [images](images.md),
[meshes](meshes.md), [cameras](cameras.md).
"""


def subjects() -> Iterator[ModuleType]:
    """Yield the modules of the tables in their order."""
    for subject in SUBJECTS:
        path = ROOT / "tools" / "formats" / f"{subject}.py"
        spec = importlib.util.spec_from_file_location(f"format_table_of_{subject}", path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        yield module


def page() -> str:
    """Return the text of the page."""
    parts = [HEAD, textwrap.fill(f"Libraries: {', '.join(_versions())}.", 120) + "\n"]
    for module in subjects():
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            rows = module.rows(Path(folder))
        read = sum(not row[2].startswith("refused") for row in rows)
        parts.append(f"## {module.TITLE}\n\n{len(rows)} files, {read} read and {len(rows) - read} refused by name.\n")
        parts.append(_table(module.COLUMNS, rows))
    return "\n".join(parts)


def _versions() -> Iterator[str]:
    for name in LIBRARIES:
        try:
            yield f"{name} {version(name)}"
        except PackageNotFoundError:
            yield f"{name} absent"


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |\n" for line in lines)


def main(arguments: Sequence[str]) -> int:
    """Write or check the page; return the exit status."""
    sys.path.insert(0, str(ROOT / "tests"))
    text = page()
    if "--check" not in arguments:
        PAGE.write_text(text, encoding="utf-8")
        return 0
    if PAGE.exists() and PAGE.read_text(encoding="utf-8") == text:
        return 0
    sys.stderr.write(f"{PAGE} is out of date; run: python tools/format_tables.py\n")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
