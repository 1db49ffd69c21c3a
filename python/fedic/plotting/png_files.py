"""PNG files of figures."""

from pathlib import Path

from matplotlib.figure import Figure

from fedic.errors import OptionError
from fedic.io.atomic import atomic_path

__all__ = ["check_picture_path", "save_figure"]


def check_picture_path(path: Path) -> None:
    """Check, before any long work, that a figure can be written to a file of this name.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    OptionError
        If the suffix is not ``.png``.
    """
    if path.suffix.lower() != ".png":
        raise OptionError(f"{path}: pictures are written as .png only; change the suffix.", "path")


def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure as PNG, whole or not at all.

    Parameters
    ----------
    figure : Figure
        The figure.
    path : Path
        The ``.png`` file; replaced if it exists.

    Raises
    ------
    OptionError
        If the suffix is not ``.png``.
    FedicError
        If the file cannot be written.
    """
    check_picture_path(path)
    with atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=160)
