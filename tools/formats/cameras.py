"""The table of camera files in docs/formats.md, from files that are written and read."""

import importlib
import sys
from pathlib import Path

TITLE = "Cameras"
COLUMNS = ("program", "file", "convention", "outcome", "by")

_TESTS = Path(__file__).resolve().parents[2] / "tests"


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
        outcome = importlib.import_module("scenes.camera_files.camera_file").outcome
    finally:
        sys.path.remove(str(_TESTS))
    return [(each.program, each.name, each.convention, outcome(each, folder), each.by) for each in files]
