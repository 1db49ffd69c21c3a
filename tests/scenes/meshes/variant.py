"""A file in a variant of a format, and what fedic should make of it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import fedic

__all__ = ["Variant", "check"]

AREA = 6.0


@dataclass(frozen=True)
class Variant:
    """A file.

    Attributes
    ----------
    format : str
        Name of the format, with the suffix.
    name : str
        What is particular.
    file : str
        Name of the file.
    write : callable
        Writes it, to the path it is given.
    cells : dict of str to int
        Number of cells of each type; empty if the file is refused.
    sets : tuple of str
        Names of the sets.
    choice : str
        Part that is chosen.
    refusal : str
        Part of the message of a file that is refused.
    reader : str
        Library that reads it.
    """

    format: str
    name: str
    file: str
    write: Callable[[Path], None]
    cells: dict[str, int] = field(default_factory=dict)
    sets: tuple[str, ...] = ()
    choice: str = ""
    refusal: str = ""
    reader: str = "fedic"

    def written(self, folder: Path) -> str:
        """Write the file, and return its path with the choice."""
        path = folder / self.file
        self.write(path)
        return f"{path}#{self.choice}" if self.choice else str(path)


def check(variant: Variant, mesh: fedic.Mesh) -> None:
    """Check that a mesh is what a variant holds."""
    assert {cell: len(nodes) for cell, nodes in mesh.cells.items()} == variant.cells
    area = AREA * variant.cells["quad"] / 6 if variant.choice == "TWO" else AREA
    np.testing.assert_allclose(mesh.areas().sum(), area, rtol=1e-6)
    assert tuple(sorted(mesh.sets)) == variant.sets
    for name, members in mesh.sets.items():
        if name.lower() == "left":
            on_the_left = (mesh.points[:, 0] == 0.0) & mesh.used_nodes
            np.testing.assert_array_equal(members.nodes, np.flatnonzero(on_the_left))
