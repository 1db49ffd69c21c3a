"""Reading of mesh files in a process of its own.

Some libraries never end on a damaged file, or end the whole process.
"""

import contextlib
import io
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic.errors import MeshError
from fedic.io._mesh_file import MeshFile, unreadable

__all__ = ["read_in_folder", "read_in_process"]

_PROGRAM = (
    "import sys; sys.path[:] = sys.argv[5:]; from fedic.io.mesh_formats._process import read_in_folder; "
    "read_in_folder(*sys.argv[1:5])"
)
_BESIDE = dict.fromkeys((".xdmf", ".xmf"), (".h5", ".hdf5", ".bin"))
_SECONDS, _SECONDS_PER_MEGABYTE = 60.0, 1.0
_BYTES, _BYTES_PER_BYTE = 4 << 30, 50
"""Limits of time and memory of the process: for any file, and for each byte of it."""


def read_in_process(module: str, name: str, path: Path, seconds: float | None = None) -> MeshFile:
    """Read a mesh file in another process, which ends at a limit of time or memory.

    Parameters
    ----------
    module, name : str
        Module of the reader in this package, and its name there.
    path : Path
        The file.
    seconds : float, optional
        Limit of time; by default 60 s, and 1 s more for each megabyte of the file.

    Returns
    -------
    MeshFile
        The contents.

    Raises
    ------
    MeshError
        If the file cannot be read, or not within the limits.
    """
    limit = _SECONDS + _SECONDS_PER_MEGABYTE * _size(path) / 2**20 if seconds is None else seconds
    with tempfile.TemporaryDirectory(prefix="fedic-") as folder:
        command = [sys.executable, "-c", _PROGRAM, module, name, str(path.resolve()), folder, *sys.path]
        try:
            ended = subprocess.run(command, capture_output=True, timeout=limit, check=False)
        except subprocess.TimeoutExpired as error:
            raise unreadable(
                path, f"the library did not read it within {limit:.0f} s: the file is damaged, or the computer is busy"
            ) from error
        except OSError as error:
            raise unreadable(path, f"Python cannot be started for it: {error}") from error
        message, result = Path(folder, "message.txt"), Path(folder, "contents.npz")
        if message.is_file():
            raise MeshError(message.read_text(encoding="utf-8").replace(str(path.resolve()), str(path)))
        if ended.returncode != 0 or not result.is_file():
            raise unreadable(path, f"the library ended with code {ended.returncode}; the file is damaged")
        return _load(result)


def _save(file: Path, contents: MeshFile) -> None:
    arrays: dict[str, NDArray[Any]] = {"points": contents.points}

    def kept(array: NDArray[Any]) -> str:
        name = f"a{len(arrays)}"
        arrays[name] = array
        return name

    names = {
        "blocks": [(cell, kept(nodes)) for cell, nodes in contents.blocks],
        "node_sets": {name: kept(nodes) for name, nodes in contents.node_sets.items()},
        "cell_sets": {name: list(map(kept, rows)) for name, rows in contents.cell_sets.items()},
        "surfaces": {
            name: [(cell, kept(nodes)) for cell, nodes in blocks] for name, blocks in contents.surfaces.items()
        },
        "parts": {name: list(map(kept, rows)) for name, rows in contents.parts.items()},
        "node_labels": None if contents.node_labels is None else kept(contents.node_labels),
        "cell_labels": None if contents.cell_labels is None else list(map(kept, contents.cell_labels)),
    }
    np.savez(file, names=np.array(json.dumps(names)), **arrays)  # type: ignore[arg-type]


def _load(file: Path) -> MeshFile:
    with np.load(file) as arrays:
        names = json.loads(str(arrays["names"]))
        of_nodes, of_cells = names["node_labels"], names["cell_labels"]
        return MeshFile(
            arrays["points"],
            [(cell, arrays[key]) for cell, key in names["blocks"]],
            {name: arrays[key] for name, key in names["node_sets"].items()},
            {name: [arrays[key] for key in keys] for name, keys in names["cell_sets"].items()},
            {name: [(cell, arrays[key]) for cell, key in faces] for name, faces in names["surfaces"].items()},
            {name: [arrays[key] for key in keys] for name, keys in names["parts"].items()},
            node_labels=None if of_nodes is None else arrays[of_nodes],
            cell_labels=None if of_cells is None else [arrays[key] for key in of_cells],
        )


def _size(path: Path) -> int:
    """Return the size of a file, and for XDMF of the files beside it that may hold its numbers."""
    suffixes = _BESIDE.get(path.suffix.lower(), ())
    with contextlib.suppress(OSError):  # the folder may not be listed, or a file be gone
        beside = [each for each in path.parent.iterdir() if each.suffix.lower() in suffixes] if suffixes else []
        return sum(each.stat().st_size for each in [path, *beside] if each.is_file())
    return path.stat().st_size


def _limit_memory(path: Path) -> None:
    try:
        import resource
    except ImportError:  # on Windows
        return
    limit = _BYTES + _BYTES_PER_BYTE * _size(path)
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    with contextlib.suppress(ValueError, OSError):  # a lower limit is set already
        resource.setrlimit(resource.RLIMIT_AS, (limit, hard))


def read_in_folder(module: str, name: str, file: str, folder: str) -> None:
    """Read a mesh file, and leave the contents or a message in a folder: what the other process does.

    Parameters
    ----------
    module, name : str
        As for `read_in_process`.
    file, folder : str
        Paths.
    """
    path = Path(file)
    _limit_memory(path)
    read: Callable[[Path], MeshFile] = getattr(import_module(f"fedic.io.mesh_formats.{module}"), name)
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            contents = read(path)
        _save(Path(folder, "contents.npz"), contents)
    except MeshError as error:
        Path(folder, "message.txt").write_text(str(error), encoding="utf-8")
