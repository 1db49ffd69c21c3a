"""Parts that commands share: error messages, tables, and options of output files."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from fedic.cli.exit_status import EXIT_ERROR, EXIT_INTERRUPTED
from fedic.cli.terminal import echo
from fedic.errors import FedicError

__all__ = [
    "CameraOption",
    "OverwriteOption",
    "PictureOption",
    "check_output",
    "check_picture",
    "reported_errors",
]

CameraOption: TypeAlias = Annotated[
    Path, typer.Option("--output", help="Camera file: .toml, or .yml, .yaml, .xml for OpenCV.")
]
PictureOption: TypeAlias = Annotated[
    Path | None, typer.Option("--picture", help="Residuals drawn over the image, a .png file.")
]
OverwriteOption: TypeAlias = Annotated[
    bool, typer.Option("--overwrite", help="Replace the output file and the picture if they exist.")
]


@contextmanager
def reported_errors() -> Iterator[None]:
    """Print the errors of fedic as sentences and exit with status 2; exit with status 130 on Ctrl-C."""
    try:
        yield
    except FedicError as error:
        echo(f"fedic: {error}", err=True)
        raise typer.Exit(EXIT_ERROR) from None
    except KeyboardInterrupt:
        echo("fedic: interrupted", err=True)
        raise typer.Exit(EXIT_INTERRUPTED) from None


def check_output(output: Path | None, suffixes: Sequence[str], inputs: Iterable[Path], *, overwrite: bool) -> None:
    """Check, before any long work, that writing a table of results replaces no file that is to be kept.

    Parameters
    ----------
    output : Path, optional
        The file.
    suffixes : sequence of str
        Suffixes that can be written.
    inputs : iterable of Path
        Images that are read.
    overwrite : bool
        If true, an existing file is replaced.

    Raises
    ------
    FedicError
        If the file cannot be written, is an input, or exists and `overwrite` is false.
    """
    if output is None:
        return
    if output.suffix.lower() not in suffixes:
        raise FedicError(f"{output}: the results cannot be written as {output.suffix!r}; give {' or '.join(suffixes)}.")
    _check_replaced(output, inputs, "the results", overwrite=overwrite)


def check_picture(picture: Path | None, images: Iterable[Path], *, overwrite: bool) -> None:
    """Check, before any long work, that writing a picture replaces no file that is to be kept.

    Parameters
    ----------
    picture : Path, optional
        The picture.
    images : iterable of Path
        Image files that are read.
    overwrite : bool
        If true, an existing picture is replaced.

    Raises
    ------
    FedicError
        If the picture cannot be written, is one of the images, or exists and `overwrite` is false.
    """
    from fedic.plotting.png_files import check_picture_path

    if picture is None:
        return
    check_picture_path(picture)
    _check_replaced(picture, images, "the picture", overwrite=overwrite)


def _check_replaced(path: Path, inputs: Iterable[Path], what: str, *, overwrite: bool) -> None:
    from fedic.io.images import split_page

    if not path.parent.is_dir():
        raise FedicError(f"{path}: the folder {path.parent} does not exist; make it first.")
    if not path.exists():
        return
    files = [split_page(each)[0] for each in inputs]
    if any(file.exists() and path.samefile(file) for file in files):
        raise FedicError(f"{path}: {what} would replace an input image; give it another name.")
    if not overwrite:
        raise FedicError(f"{path}: this file exists and was not changed; --overwrite replaces it by {what}.")
