"""The example patches of CONTRIBUTING apply to the tree, and the command in their header passes."""

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PATCHES = sorted((ROOT / "docs" / "contributing").glob("*.patch"))


def listed_files() -> list[str]:
    """Return the files under version control, or skip."""
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("no git clone")
    listing = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True)
    return [name for name in listing.stdout.split("\0") if name and (ROOT / name).is_file()]


def header(patch: Path) -> dict[str, str]:
    """Return the fields ``Name: value`` before the first difference."""
    text = patch.read_text().partition("diff --git")[0]
    return dict(re.findall(r"^(\w+): (.+)$", text, flags=re.MULTILINE))


def test_contributing_lists_every_patch() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text()
    assert PATCHES
    assert set(re.findall(r"docs/contributing/([\w-]+\.patch)", text)) == {patch.name for patch in PATCHES}


@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.stem)
def test_an_addition_touches_at_most_three_files_besides_tests(patch: Path) -> None:
    changed = re.findall(r"^diff --git a/(\S+)", patch.read_text(), flags=re.MULTILINE)
    written = [name for name in changed if "/tests/" not in f"/{name}" and name not in generated_files()]
    assert 1 <= len(written) <= 3, written


def generated_files() -> set[str]:
    """Return the files that a target writes, which no one edits by hand."""
    names = subprocess.run(
        ["git", "grep", "-l", "--max-depth", "9", "Do not edit"], cwd=ROOT, check=False, capture_output=True, text=True
    ).stdout.split()
    return {name for name in names if not name.startswith("tests/")}


def patched_copy(patch: Path) -> Path:
    """Apply a patch to a copy of the tree, at a fixed place so that unchanged files are not compiled again."""
    copy = ROOT / "target" / "contributing" / patch.stem
    shutil.rmtree(copy, ignore_errors=True)
    for name in listed_files():
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, copy / name)
    subprocess.run(["git", "init", "-q"], cwd=copy, check=True)
    applied = subprocess.run(["git", "apply", str(patch)], cwd=copy, check=False, capture_output=True, text=True)
    assert applied.returncode == 0, applied.stderr
    return copy


@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.stem)
def test_a_patch_applies_and_its_command_passes(patch: Path) -> None:
    copy = patched_copy(patch)
    command = shlex.split(header(patch)["Test"])
    if shutil.which(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed")
    environment = {"CARGO_TARGET_DIR": str(ROOT / "target")} | os.environ
    run = subprocess.run(command, cwd=copy, env=environment, check=False, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
