"""The files that a run writes: their names, which replace no input, and the folder they go to."""

import contextlib
import json
import os
import stat
import unicodedata
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from fedic.errors import ConfigError, FedicError
from fedic.io.atomic import check_folder_writable, make_folder, remove_unfinished
from fedic.io.images import image_stem, split_page

__all__ = ["DISPLACEMENT", "MESH_PICTURE", "RESIDUAL", "RESULTS", "SUMMARY", "Outputs", "remove", "result_names"]

SUMMARY, MESH_PICTURE, RESULTS = "summary.json", "mesh.png", "results.vtkhdf"
_ENDINGS = (".vtu", ".npz")
DISPLACEMENT: dict[Literal["x", "y"], str] = {"x": "_displacement_x.png", "y": "_displacement_y.png"}
RESIDUAL = "_residual.png"
_MOST_BYTES = 2**28


@dataclass(frozen=True)
class Outputs:
    """Where the results of a run go.

    Attributes
    ----------
    folder : Path
        The folder.
    names : list of str
        Name of the results of each deformed image, to which the endings of the files are added.
    endings : tuple of str
        Endings of the files of each image besides the pictures, such as ``".vtu"``.
    pictures : bool
        Whether pictures are drawn.
    inputs : list of (str, Path)
        The files that are read, and the keys that name them.
    """

    folder: Path
    names: list[str]
    endings: tuple[str, ...]
    pictures: bool
    inputs: list[tuple[str, Path]]

    @property
    def results(self) -> Path:
        """The file with all frames."""
        return self.folder / RESULTS

    def of_frame(self, name: str) -> list[Path]:
        """Return the files of a deformed image."""
        endings = (*self.endings, *DISPLACEMENT.values(), RESIDUAL) if self.pictures else self.endings
        return [self.folder / f"{name}{ending}" for ending in endings]

    def all(self) -> list[Path]:
        """Return every file but the summary and that with all frames."""
        files = [self.folder / MESH_PICTURE] if self.pictures else []
        return [*files, *(file for name in self.names for file in self.of_frame(name))]

    def check(self) -> None:
        """Check that no file would replace an input or something that is not a file.

        Raises
        ------
        ConfigError
            If one would.
        """
        files = [self.folder / SUMMARY, self.results, *self.all()]
        for file in files:
            status = _status(file)
            if status is not None and not stat.S_ISREG(status.st_mode):
                raise ConfigError(
                    f"output.folder: the result {file} cannot be written, since there is a folder or another kind of "
                    "file of this name; give another folder.",
                    "output.folder",
                )
        self._refuse_inputs(files, "would replace")

    def claim(self, *, overwrite: bool) -> None:
        """Make the folder, check that it can be written, and remove unfinished files.

        Parameters
        ----------
        overwrite : bool
            If true, results may be there; `clear` removes them.

        Raises
        ------
        FedicError
            If the folder cannot be written, or holds results without the file of all frames, from which a run could go
            on, and `overwrite` is false.
        """
        make_folder(self.folder)
        there = [file for file in (self.folder / SUMMARY, *self.all()) if os.path.lexists(file)]
        if there and not overwrite and not os.path.lexists(self.results):
            raise FedicError(
                f"{self.folder}: this folder holds results already, such as {there[0].name}, and was not changed; give "
                "another output.folder, or --overwrite (overwrite=True), which removes them first."
            )
        self._refuse_inputs(self._listed(), "is a result of an earlier run, which --overwrite removes:")
        check_folder_writable(self.folder)
        remove_unfinished(self.folder)

    def clear(self) -> None:
        """Remove the results of an earlier run: the files that its summary lists, and those of the names of this run.

        Raises
        ------
        FedicError
            If one cannot be removed.
        """
        for file in (*self._listed(), *self.all()):
            remove(file)

    def _listed(self) -> list[Path]:
        """Return the files that an earlier summary lists and that are in the folder."""
        summary = self.folder / SUMMARY
        names: object = None
        with contextlib.suppress(OSError, ValueError, RecursionError, AttributeError):
            if summary.stat().st_size <= _MOST_BYTES:
                names = json.loads(summary.read_text(encoding="utf-8")).get("files")
        if not isinstance(names, list):
            return []
        plain = [name for name in names if isinstance(name, str) and _is_result_name(name)]
        return [file for file in (self.folder / name for name in plain) if file.is_symlink() or file.is_file()]

    def _refuse_inputs(self, files: Iterable[Path], what: str) -> None:
        inputs = {identity: entry for entry in self.inputs if (identity := _identity(entry[1])) is not None}
        for file in files:
            identity = _identity(file)
            if identity in inputs:
                key, path = inputs[identity]
                raise ConfigError(
                    f"output.folder: the result {file} {what} an input of this run, {path} ({key}); give another "
                    "folder.",
                    "output.folder",
                )


def result_names(images: Sequence[Path]) -> list[str]:
    """Name the results of images: by the stem, or by as much more as tells them apart.

    Two names are different if they are on a file system that ignores case and composition of letters.

    Parameters
    ----------
    images : sequence of Path
        The images.

    Returns
    -------
    list of str
        One name for each: ``frame``; of those alike ``frame_png``, else with the folders, ``left_frame``, else with
        numbers, ``frame_1``.
    """
    names = [image_stem(image) for image in images]
    depth = max((len(image.parts) for image in images), default=0)
    more: list[Callable[[Path], str]] = [_with_suffix]
    more += [_with_folders(count) for count in range(1, depth)]
    for longer in more:
        alike = _alike(names)
        tried = [longer(image) if same else name for image, name, same in zip(images, names, alike, strict=True)]
        if not any(_alike(tried)):
            return tried
    taken = {_folded(name) for name in names}
    for index, same in enumerate(_alike(names)):
        number = 1
        while same and _folded(f"{image_stem(images[index])}_{number}") in taken:
            number += 1
        if same:
            names[index] = f"{image_stem(images[index])}_{number}"
            taken.add(_folded(names[index]))
    return names


def remove(file: Path) -> None:
    """Remove a file, if it is there.

    Parameters
    ----------
    file : Path
        The file.

    Raises
    ------
    FedicError
        If it cannot be removed.
    """
    try:
        file.unlink(missing_ok=True)
    except OSError as error:
        if _status(file) is not None:
            raise FedicError(f"{file}: the older file cannot be removed ({error.strerror}).") from error


def _with_suffix(image: Path) -> str:
    return f"{image_stem(image)}_{split_page(image)[0].suffix.removeprefix('.')}"


def _with_folders(count: int) -> Callable[[Path], str]:
    def name(image: Path) -> str:
        folders = [part for part in image.parent.parts[-count:] if part not in (image.anchor, "..")]
        return "_".join([*folders, image_stem(image)])

    return name


def _alike(names: Iterable[str]) -> list[bool]:
    folded = [_folded(name) for name in names]
    counts = Counter(folded)
    return [counts[name] > 1 for name in folded]


def _folded(name: str) -> str:
    return unicodedata.normalize("NFC", name.casefold())


def _is_result_name(name: str) -> bool:
    return Path(name).name == name and name.endswith((*_ENDINGS, ".png")) and "\0" not in name


def _status(path: Path) -> os.stat_result | None:
    """Return the status of the file that a path leads to; None if there is none, or it cannot be looked up."""
    try:
        return path.stat()
    except OSError:
        return None


def _identity(path: Path) -> tuple[int, int] | None:
    status = _status(path)
    return None if status is None else (status.st_dev, status.st_ino)
