"""Table of the mesh files that are read."""

from pathlib import Path

import fedic
from scenes.meshes.variant import Variant, check
from scenes.meshes.variants import VARIANTS
from scenes.refusal import refusal

TITLE = "Meshes"
COLUMNS = ("format", "variant", "outcome", "by")


def rows(folder: Path) -> list[tuple[str, ...]]:
    """Write each file, read it and compare cells, area and sets with those written.

    Parameters
    ----------
    folder : Path
        Where the files are written.

    Returns
    -------
    list of tuple of str
        Format, variant, outcome and library.

    Raises
    ------
    AssertionError
        If a file gives another mesh, or another reason, than it should.
    """
    return [
        (variant.format, variant.name, _outcome(variant, folder / f"{index}"), variant.reader)
        for index, variant in enumerate(VARIANTS)
    ]


def _outcome(variant: Variant, folder: Path) -> str:
    folder.mkdir()
    name = variant.written(folder)
    if not variant.refusal:
        check(variant, fedic.read_mesh(name))
        return "read"
    assert variant.refusal in (reason := refusal(fedic.read_mesh, name)), f"{variant}: {reason}"
    return f"refused: {variant.refusal}"
