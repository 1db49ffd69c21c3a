"""The table of camera files in docs/formats.md, from files that are written and read here."""

import importlib
import re
import sys
from pathlib import Path

import numpy as np

import fedic

TITLE = "Cameras"
COLUMNS = ("program", "file", "convention", "outcome", "by")

_TESTS = Path(__file__).resolve().parents[2] / "tests"
_TOLERANCE_PX = 1e-6


def rows(folder: Path) -> list[tuple[str, ...]]:
    """Return one row per variant.

    Parameters
    ----------
    folder : Path
        Where the files are written.

    Returns
    -------
    list of tuple of str
        The rows, with the columns `COLUMNS`.

    Raises
    ------
    AssertionError
        If a camera is read wrong, or a file is not refused with the reason that it should be.
    """
    sys.path.insert(0, str(_TESTS))
    try:
        files = importlib.import_module("scenes.camera_files").FILES
    finally:
        sys.path.remove(str(_TESTS))
    return [(each.program, each.name, each.convention, outcome(each, folder), each.by) for each in files]


def outcome(each, folder: Path) -> str:  # type: ignore[no-untyped-def] # a CameraFile of the tests
    """Return ``"read"``, or ``"refused"`` and the reason, after a check of either."""
    path = each.make(folder)
    if isinstance(each.expected, str):
        try:
            fedic.read_camera(path, number=each.number)
        except fedic.CameraError as error:
            assert re.search(each.expected, str(error)), f"{each.program}: {error}"
            reason = str(error).removeprefix(f"{path}: ").split(": ")
            return f"refused: {reason[0]}"
        raise AssertionError(f"{each.program} is read, and should be refused")
    found = fedic.read_camera(path, number=each.number)
    x, y = np.meshgrid(np.linspace(-0.25, 0.25, 5), np.linspace(-0.2, 0.2, 5))
    points = 900.0 * np.column_stack([x.ravel(), y.ravel(), np.ones(x.size)])
    points = (points - each.expected.translation) @ each.expected.rotation
    error = np.abs(found.project(points) - each.expected.project(points)).max()
    assert error < _TOLERANCE_PX, f"{each.program}: {error} px"
    assert found.image_size == each.expected.image_size, f"{each.program}: {found.image_size}"
    return "read"
