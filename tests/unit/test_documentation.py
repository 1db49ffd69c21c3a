"""Links and paths in the documentation exist."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    page
    for folder in (
        ROOT,
        ROOT / "docs",
        ROOT / "docs" / "internals",
        ROOT / "benches",
        ROOT / "findings",
        ROOT / "tests",
    )
    for page in folder.glob("*.md")
)


def anchors(page: Path) -> set[str]:
    """Return the anchors of the headings of a page, and those set by hand."""
    text = page.read_text()
    headings = re.findall(r"^#+ (.+)$", text, flags=re.MULTILINE)
    slugs = {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}
    return slugs | set(re.findall(r'<a id="([^"]+)"', text))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_relative_links_lead_to_a_file_and_heading(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if "://" in target:
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        assert file.exists(), f"{target} does not exist"
        if anchor:
            assert anchor in anchors(file), f"no heading of {target}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_files_named_in_the_text_exist(page: Path) -> None:
    for name in re.findall(
        r"`((?:tests|crates|benches|docs|python|examples|findings)/[\w./-]+\.\w+)`", page.read_text()
    ):
        assert (ROOT / name).is_file(), name


def test_every_finding_is_listed_and_executable() -> None:
    folder = ROOT / "findings"
    scripts = {script.name for script in folder.glob("*.sh")}
    assert set(re.findall(r"\]\(([\w-]+\.sh)\)", (folder / "README.md").read_text())) == scripts
    for name in scripts:
        assert (folder / name).stat().st_mode & 0o111, name
        subprocess.run(["bash", "-n", folder / name], check=True)
