"""Table of the mesh files of finite element programs."""

from pathlib import Path

import numpy as np

import fedic
from scenes.finite_element_files import FILES, FiniteElementFile

TITLE = "Meshes of finite element programs"
COLUMNS = ("program", "variant", "outcome", "by")


def rows(folder: Path) -> list[tuple[str, ...]]:
    """Write each file, read it and compare the mesh with the plate that it holds.

    Parameters
    ----------
    folder : Path
        Where the files are written.

    Returns
    -------
    list of tuple of str
        Program, variant, outcome and library.

    Raises
    ------
    AssertionError
        If a file gives another mesh, or another reason, than it should.
    """
    found = []
    for index, file in enumerate(FILES):
        (folder / str(index)).mkdir()
        found.append((file.program, file.variant, outcome(file, folder / str(index)), "fedic"))
    return found


def outcome(file: FiniteElementFile, folder: Path) -> str:
    """Write and read one file.

    Parameters
    ----------
    file : FiniteElementFile
        The file.
    folder : Path
        Where it is written.

    Returns
    -------
    str
        ``"read"``, or ``"refused: "`` with the reason.

    Raises
    ------
    AssertionError
        If the file gives another mesh, or another reason, than it should.
    """
    path, reason = file.write(folder), ""
    try:
        mesh = fedic.read_mesh(path)
    except fedic.MeshError as error:
        reason = str(error)
    what = f"{file.program}, {file.variant}: {reason or 'it was read'}"
    assert bool(reason) == bool(file.refused), what
    assert file.refused in reason, what
    if not reason:
        assert np.isclose(mesh.areas().sum(), 200.0, rtol=1e-12), f"{what}: {mesh.areas()}"
    return f"refused: {file.refused}" if reason else "read"
