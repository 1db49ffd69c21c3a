"""The table of camera files in docs/formats.md, from files that are written and read."""

from pathlib import Path

from scenes.camera_files import FILES
from scenes.camera_files.camera_file import outcome

TITLE = "Cameras"
COLUMNS = ("program", "file", "convention", "outcome", "by")


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
    return [(each.program, each.name, each.convention, outcome(each, folder), each.by) for each in FILES]
