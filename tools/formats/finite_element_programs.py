"""Table of the mesh files of finite element programs."""

from pathlib import Path

from scenes.finite_element_files import FILES, outcome

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
