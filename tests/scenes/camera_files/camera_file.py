"""A camera file of a program, and what reading it should give."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import fedic

_X, _Y = np.meshgrid(np.linspace(-0.25, 0.25, 5), np.linspace(-0.2, 0.2, 5))
_RAYS = 900.0 * np.column_stack([_X.ravel(), _Y.ravel(), np.ones(_X.size)])
_TOLERANCE_PX = 1e-6


@dataclass(frozen=True)
class CameraFile:
    """A file of a program.

    Attributes
    ----------
    program : str
        Program and variant.
    name : str
        Name of the file.
    write : str, bytes or callable
        Its content, or a function that writes it.
    expected : Pinhole or str
        The camera in it, or what the error says.
    convention : str
        Units, signs, order, origin of the pixels.
    by : str
        Library that reads the syntax.
    number : int
        Camera in the file.
    """

    program: str
    name: str
    write: str | bytes | Callable[[Path], None]
    expected: Any
    convention: str
    by: str
    number: int = 0

    def make(self, folder: Path) -> Path:
        """Write the file."""
        path = folder / self.name
        if callable(self.write):
            self.write(path)
        elif isinstance(self.write, bytes):
            path.write_bytes(self.write)
        else:
            path.write_text(self.write, encoding="utf-8")
        return path


def outcome(file: CameraFile, folder: Path) -> str:
    """Return ``"read"``, or ``"refused: "`` and the reason; raise AssertionError if it is not what it should be."""
    path = file.make(folder)
    if isinstance(file.expected, str):
        reason = _reason(file, path)
        assert reason.startswith(f"{path}: "), reason
        match = re.search(file.expected, reason)
        assert match is not None, f"{file.program}: {reason}"
        return f"refused: {match[0]}"
    found = fedic.read_camera(path, number=file.number)
    assert isinstance(found, fedic.Pinhole)
    points = (_RAYS - file.expected.translation) @ file.expected.rotation
    error = np.abs(found.project(points) - file.expected.project(points)).max()
    assert error < _TOLERANCE_PX, f"{file.program}: {error} px"
    assert found.image_size == file.expected.image_size, f"{file.program}: {found.image_size}"
    return "read"


def _reason(file: CameraFile, path: Path) -> str:
    try:
        fedic.read_camera(path, number=file.number)
    except fedic.CameraError as error:
        return str(error)
    return "the file is read"
