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


def patched_copy() -> Path:
    """Apply all patches to a copy of the tree.

    The copy has a version of its own. Its crates are therefore not mixed up with those of the tree in the target
    folder, while the dependencies compiled there serve both.
    """
    copy = ROOT / "target" / "contributing"
    shutil.rmtree(copy, ignore_errors=True)
    for name in listed_files():
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, copy / name)
    subprocess.run(["git", "init", "-q"], cwd=copy, check=True)
    applied = subprocess.run(
        ["git", "apply", *map(str, PATCHES)], cwd=copy, check=False, capture_output=True, text=True
    )
    assert applied.returncode == 0, applied.stderr
    workspace = copy / "Cargo.toml"
    text, count = re.subn(
        r'^version = "([^"]+)"$', r'version = "\1+patched"', workspace.read_text(), flags=re.MULTILINE
    )
    assert count == 1
    workspace.write_text(text)
    return copy


@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.stem)
def test_a_patch_applies_by_itself(patch: Path) -> None:
    listed_files()
    command = ["git", "apply", "--check", str(patch)]
    applied = subprocess.run(command, cwd=ROOT, check=False, capture_output=True, text=True)
    assert applied.returncode == 0, applied.stderr


def test_the_commands_of_the_patches_pass() -> None:
    """One test, so that no two processes write the same copy and its crates are compiled once."""
    copy = patched_copy()
    for patch in PATCHES:
        command = shlex.split(header(patch)["Test"])
        if shutil.which(command[0]) is None:
            pytest.skip(f"{command[0]} is not installed")
        environment = {"CARGO_TARGET_DIR": str(ROOT / "target")} | os.environ
        run = subprocess.run(command, cwd=copy, env=environment, check=False, capture_output=True, text=True)
        assert run.returncode == 0, f"{patch.name}: {run.stdout}{run.stderr}"
