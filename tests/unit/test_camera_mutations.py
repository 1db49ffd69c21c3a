"""Damaged camera files: each is read, or refused with a CameraError."""

import contextlib
import warnings
from pathlib import Path

import numpy as np
import pytest

import fedic
from scenes.camera_files import FILES
from scenes.camera_files.camera_file import CameraFile

MUTANTS = 120
WORDS = (
    b"nan",
    b"-1",
    b"1e400",
    b"[",
    b"]",
    b"{",
    b"\n",
    b"---\n",
    b": ",
    b"<a>",
    b"\x00",
    b"\xff",
    b"&a ",
    b"*a",
    b"99999999999",
)


def mutated(content: bytes, random: np.random.Generator) -> bytes:
    """Return a content with a few bytes or words changed, left out or repeated, or cut."""
    for _ in range(random.integers(1, 5)):
        start, length = int(random.integers(0, len(content) + 1)), int(random.integers(0, 30))
        kind = random.integers(0, 5)
        if kind == 0:
            content = content[:start] + random.bytes(1) + content[start + 1 :]
        elif kind == 1:
            content = content[:start] + content[start + length :]
        elif kind == 2:
            content = content[:start] + WORDS[random.integers(0, len(WORDS))] + content[start:]
        elif kind == 3:
            content = content[:start] + content[start : start + length] * 2 + content[start + length :]
        else:
            content = content[: max(1, start)]
    return content


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.program)
def test_a_damaged_file_is_read_or_refused(file: CameraFile, tmp_path: Path) -> None:
    pytest.importorskip("h5py" if file.by == "h5py" else "scipy" if file.name.endswith(".mat") else "numpy")
    path = file.make(tmp_path)
    content, random = path.read_bytes(), np.random.default_rng(len(file.program))
    read = 0
    for _ in range(MUTANTS):
        path.write_bytes(mutated(content, random))
        with warnings.catch_warnings(), contextlib.suppress(fedic.CameraError):
            warnings.simplefilter("ignore", fedic.CalibrationWarning)
            fedic.read_camera(path, number=file.number).project([[0.0, 0.0, 900.0]])
            read += 1
    assert read < MUTANTS
