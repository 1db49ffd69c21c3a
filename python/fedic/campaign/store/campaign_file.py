"""The file of a campaign: frames are added one by one, each as a whole, and read again."""

import contextlib
import errno
import json
import shutil
import threading
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fedic._core import __version__
from fedic.campaign.setup import Setup, setup_entries, setup_from_entries
from fedic.campaign.store.frame_data import FrameData
from fedic.campaign.store.layout import COLUMNS, FORMAT, INFORMATION, UNCHECKED
from fedic.campaign.store.structure import (
    bytes_per_frame,
    create,
    datasets_of_frames,
    read_mask,
    read_mesh,
    read_text,
)
from fedic.errors import FedicError
from fedic.io.atomic import atomic_path

__all__ = ["CampaignFile"]

_STREAM_CAPACITY = 16
"""Frames that a file for an unknown number of frames has room for at first."""
_FREE_BYTES = 2**24
"""Room that is left on the disk."""
_WRITTEN: set[Path] = set()
"""Files that this process has open for writing."""


class CampaignFile:
    """The frames of a campaign in an HDF5 file, or in memory.

    Parameters
    ----------
    path : Path or None
        The file; None to keep the frames in memory.
    """

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self._file: Any = None
        self._lock = threading.RLock()

    @property
    def exists(self) -> bool:
        """Whether there is a file, or frames in memory."""
        return self._file is not None or (self.path is not None and self.path.exists())

    @property
    def name(self) -> str:
        """Name for messages."""
        return "the frames in memory" if self.path is None else str(self.path)

    def create(
        self, setup: Setup, reference: Mapping[str, Any], capacity: int | None, *, overwrite: bool = False
    ) -> None:
        """Make the file, without frames, and open it for writing.

        Parameters
        ----------
        setup : Setup
            What is measured with.
        reference : mapping
            JSON types that identify the reference image.
        capacity : int or None
            Number of frames; None if it is not known.
        overwrite : bool
            Whether to replace a file that exists.

        Raises
        ------
        FedicError
            If the file cannot be made, or there is not enough room for the frames.
        """
        texts = {
            "settings": json.dumps(setup_entries(setup)),
            "reference": json.dumps(dict(reference)),
            "versions": json.dumps({"fedic": __version__, "numpy": np.__version__, "h5py": h5py.version.version}),
        }
        drift = setup.reference_update != "first"
        room = capacity or _STREAM_CAPACITY
        needed = room * bytes_per_frame(setup.mesh, setup.strain_measure, drift=drift)

        def write(file: Any) -> None:
            create(file, setup.mesh, setup.mask, texts, setup.strain_measure, room, drift=drift)

        self._replace(write, needed, is_new=not overwrite)

    def open(self) -> None:
        """Open the file for writing.

        Raises
        ------
        FedicError
            If it is no file of a campaign, of another version of the format, or is being written by another process.
        """
        if self._file is None:
            assert self.path is not None, "frames in memory are open from their first one on"
            # HDF5 locks a file against other processes only.
            if self.path.resolve() in _WRITTEN:
                raise _is_being_written(self.path)
            self._file = _opened(self.path, "r+")
            _WRITTEN.add(self.path.resolve())

    def close(self) -> None:
        """Close the file; frames in memory are kept."""
        with self._lock:
            if self._file is not None and self.path is not None:
                file, self._file = self._file, None
                _WRITTEN.discard(self.path.resolve())
                # After a full disk closing fails too; the frames that were committed are on it.
                with contextlib.suppress(OSError, RuntimeError):
                    file.close()

    @contextmanager
    def reading(self) -> Iterator[Any]:
        """Provide the open file.

        Yields
        ------
        h5py.File
            The file.

        Raises
        ------
        FedicError
            If it cannot be read.
        """
        with self._lock:
            if self._file is not None:
                yield self._file
                return
            if self.path is None:
                raise FedicError("this campaign has no frames yet; call run() first.")
            with _opened(self.path, "r") as file:
                yield file

    def add(self, data: FrameData, seconds: float) -> None:
        """Add the next frame.

        Parameters
        ----------
        data : FrameData
            The frame; its number is that of the frames before.
        seconds : float
            Time that it took.

        Raises
        ------
        FedicError
            If it cannot be written. The frames before are not lost.
        """
        with self._lock:
            steps = self._file["VTKHDF/Steps"]
            assert data.index == int(steps.attrs["NSteps"]), "frames are added in their order"
            if data.index == len(steps["Values"]):
                self.resize(2 * data.index)
            try:
                self._write(data, seconds)
            except (OSError, RuntimeError) as error:
                raise FedicError(f"{self.name}: a frame cannot be written ({_reason(error)}).") from error

    def resize(self, capacity: int) -> None:
        """Make room for another number of frames.

        Parameters
        ----------
        capacity : int
            Number of frames, not less than there are.

        Raises
        ------
        FedicError
            If there is not enough room on the disk.
        """
        with self._lock:
            old = self._file
            mesh, settings = read_mesh(old), read_text(old, "settings")
            measure, drift = settings["strain_measure"], settings["reference_update"] != "first"
            count = int(old["VTKHDF/Steps"].attrs["NSteps"])
            texts = {name: bytes(old["fedic"][name][()]).decode() for name in ("settings", "reference", "versions")}

            def write(file: Any) -> None:
                create(file, mesh, read_mask(old), texts, measure, capacity, drift=drift)
                for name, rows in datasets_of_frames(old):
                    for frame in range(count):
                        part = slice(frame * rows, (frame + 1) * rows)
                        file[name][part] = old[name][part]
                file["VTKHDF/Steps"].attrs["NSteps"] = np.int64(count)

            self._replace(write, capacity * bytes_per_frame(mesh, measure, drift=drift))

    def num_frames(self) -> int:
        """Return the number of finished frames."""
        with self.reading() as file:
            return int(file["VTKHDF/Steps"].attrs["NSteps"])

    def capacity(self) -> int:
        """Return the number of frames that there is room for."""
        with self.reading() as file:
            return len(file["VTKHDF/Steps/Values"])

    def text(self, name: str) -> Any:
        """Return the JSON types of a text of the group ``fedic``."""
        with self.reading() as file:
            return read_text(file, name)

    def setup(self) -> Setup:
        """Return what was measured with."""
        with self.reading() as file:
            path = Path("memory") if self.path is None else self.path
            return setup_from_entries(read_text(file, "settings"), read_mesh(file), read_mask(file), path)

    def columns(self, names: Iterable[str]) -> dict[str, Any]:
        """Return the values of all finished frames by names of `COLUMNS`."""
        with self.reading() as file:
            count = int(file["VTKHDF/Steps"].attrs["NSteps"])
            group = file["fedic/frames"]
            return {name: group[name][:count] for name in names}

    def frame(self, index: int) -> FrameData:
        """Return the data of a frame.

        Parameters
        ----------
        index : int
            Its number.

        Returns
        -------
        FrameData
            The data.
        """
        with self.reading() as file:
            grid, own = file["VTKHDF"], file["fedic/frames"]
            arrays = {}
            for group, count in (("PointData", "NumberOfPoints"), ("CellData", "NumberOfCells")):
                rows = int(grid[count][0])
                for name in grid[group]:
                    arrays[f"{group}/{name}"] = grid[group][name][index * rows : (index + 1) * rows]
            nodes, cells = int(grid["NumberOfPoints"][0]), int(grid["NumberOfCells"][0])
            unchecked = own[UNCHECKED][index * nodes : (index + 1) * nodes]
            information = own[INFORMATION][index * cells : (index + 1) * cells]
            columns = {each.name: own[each.name][index] for each in COLUMNS}
            return FrameData(index, arrays, unchecked, information, columns)

    def _write(self, data: FrameData, seconds: float) -> None:
        """Write a frame, and then the number of frames: what counts as finished is complete."""
        file, index = self._file, data.index
        grid, own = file["VTKHDF"], file["fedic/frames"]
        for name, values in data.fields.items():
            rows = len(values)
            grid[name][index * rows : (index + 1) * rows] = values
        for name, rows_of_frame in ((UNCHECKED, data.unchecked), (INFORMATION, data.information)):
            rows = len(rows_of_frame)
            own[name][index * rows : (index + 1) * rows] = rows_of_frame
        for name, value in data.columns.items():
            own[name][index] = value
        own["seconds"][index] = seconds
        steps = grid["Steps/Values"]
        before = float(steps[index - 1]) if index else -1.0
        time = float(data.columns["time"])
        # VTK takes times that increase.
        steps[index] = time if (index == 0 and np.isfinite(time)) or time > before else before + 1.0
        file.flush()
        grid["Steps"].attrs.modify("NSteps", np.int64(index + 1))
        file.flush()

    def _replace(self, write: Callable[[Any], None], needed: int, *, is_new: bool = False) -> None:
        """Make a new file, whole or not at all, in the place of the present one, and open it for writing."""
        if self.path is None:
            # HDF5 takes two files of one name as the same one, in memory too.
            file = h5py.File(f"fedic-{uuid.uuid4().hex}", "w", driver="core", backing_store=False)
            write(file)
            self._file = file
            return
        if self._file is None:
            _check_unlocked(self.path)
        _check_room(self.path, needed)
        with atomic_path(self.path) as temporary:
            try:
                with h5py.File(temporary, "w") as file:
                    write(file)
            except RuntimeError as error:
                raise OSError(errno.EIO, str(error)) from error
            if is_new and self.path.exists():
                raise FedicError(f"{self.path}: another run has made this file meanwhile; write to another file.")
            self.close()
        self.open()


def _opened(path: Path, mode: str) -> Any:
    try:
        file = h5py.File(path, mode, locking=True)
    except FileNotFoundError:
        raise FedicError(f"{path}: there is no such file of results; check the path.") from None
    except BlockingIOError:
        raise _is_being_written(path) from None
    except PermissionError as error:
        raise FedicError(f"{path}: the file cannot be opened ({_reason(error)}).") from error
    except OSError as error:
        raise FedicError(f"{path}: this is not a file of results of a campaign, or it is damaged ({error}).") from error
    own = file.get("fedic")
    if own is None or "VTKHDF" not in file or "format" not in own.attrs:
        file.close()
        raise FedicError(f"{path}: this file was not written by a campaign of fedic.")
    version = int(own.attrs["format"])
    if version != FORMAT:
        writer = bytes(own.attrs["version"]).decode()
        file.close()
        raise FedicError(
            f"{path}: the file has version {version} of the format, written by fedic {writer}; this is fedic "
            f"{__version__}, which reads version {FORMAT}. Read it with the fedic that wrote it, or measure again into "
            "another file."
        )
    return file


def _check_unlocked(path: Path) -> None:
    """Check that no run writes a file that is to be replaced."""
    if path.resolve() in _WRITTEN:
        raise _is_being_written(path)
    try:
        h5py.File(path, "r+", locking=True).close()
    except BlockingIOError:
        raise _is_being_written(path) from None
    except OSError:
        # There is none, or it is something else, which may be replaced.
        return


def _is_being_written(path: Path) -> FedicError:
    return FedicError(
        f"{path}: the file is being written by another run; wait until it ends, or write to another file."
    )


def _check_room(path: Path, needed: int) -> None:
    if not path.parent.is_dir():
        raise FedicError(f"{path}: the folder {path.parent} does not exist; make it first.")
    free = shutil.disk_usage(path.parent).free
    if needed + _FREE_BYTES > free:
        raise FedicError(
            f"{path}: the frames take {needed / 1e6:.0f} MB, and {free / 1e6:.0f} MB are free on this disk; make room "
            "or write to another disk."
        )


def _reason(error: BaseException) -> str:
    code = getattr(error, "errno", None)
    return str(error) if code is None else f"{errno.errorcode.get(code, code)}: {error}"
