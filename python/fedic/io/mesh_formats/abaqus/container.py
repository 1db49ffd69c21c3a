"""A part, an instance or an assembly of an Abaqus model while it is read."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from fedic.io.mesh_formats._coordinates import Array, System
from fedic.io.mesh_formats._labelled_mesh import LabelledMesh, Labels
from fedic.io.mesh_formats.abaqus.lines import Line

__all__ = ["Budget", "Container", "SetBlock", "SurfaceBlock"]

MAX_GENERATED = 5_000_000
"""Largest number of nodes and elements that the keywords of one file may generate."""


@dataclass
class Budget:
    """How many nodes and elements the keywords of a file may still generate."""

    left: int = MAX_GENERATED

    def spend(self, count: int) -> None:
        """Take what a line generates from the budget.

        Parameters
        ----------
        count : int
            Number of nodes or elements.

        Raises
        ------
        ValueError
            If the budget is exceeded.
        """
        self.left -= count
        if self.left < 0:
            raise ValueError(f"with {count} more, over {MAX_GENERATED} nodes and elements would be generated")


class SurfaceBlock(NamedTuple):
    """One ``*SURFACE``: element sets or elements with the names of their faces."""

    name: str
    line: Line
    faces: list[tuple[str, str]]
    outer: bool = False


@dataclass
class SetBlock:
    """One ``*NSET`` or ``*ELSET`` block, or the set that another keyword names.

    Attributes
    ----------
    kind : str
        ``"node"`` or ``"element"``.
    name : str
        Name of the set.
    line : Line
        Where it is defined.
    items : list of ndarray of int, range or str
        Numbers, and names of other sets.
    of_elements : str
        Element set whose nodes make the node set.
    instance : str
        In a set of the assembly, the instance whose numbers and sets are meant, in capitals.
    outer : bool
        True for sets of the assembly.
    unsorted : bool
        True if the members keep the order in which they are given.
    """

    kind: str
    name: str
    line: Line
    items: list[Labels | range | str] = field(default_factory=list)
    of_elements: str = ""
    instance: str = ""
    outer: bool = False
    unsorted: bool = False


@dataclass(eq=False)
class Container:
    """What stands between ``*PART`` and ``*END PART``, or the like; numbers and names are local to it.

    Attributes
    ----------
    kind : str
        ``"PART"``, ``"INSTANCE"``, ``"ASSEMBLY"``, or empty for a file without parts.
    name, part : str
        Name, and for an instance the name of its part.
    line : Line or None
        The keyword line.
    mesh : LabelledMesh
        Nodes and elements.
    sets, surfaces : list
        In the order of the file.
    system : System or None
        Coordinate system of ``*SYSTEM``.
    placement : list of (Line, list of float)
        Data lines of ``*INSTANCE``.
    budget : Budget
        One for all containers of a file.
    has_rigid_body : bool
        In the first container, whether the file has ``*RIGID BODY``.
    """

    kind: str = ""
    name: str = ""
    part: str = ""
    line: Line | None = None
    mesh: LabelledMesh = field(default_factory=LabelledMesh)
    sets: list[SetBlock] = field(default_factory=list)
    surfaces: list[SurfaceBlock] = field(default_factory=list)
    system: System | None = None
    placement: list[tuple[Line, list[float]]] = field(default_factory=list)
    budget: Budget = field(default_factory=Budget)
    has_rigid_body: bool = False

    def add_nodes(self, labels: list[int], points: Array) -> None:
        """Add nodes; a node that is there already is moved.

        Parameters
        ----------
        labels : list of int
            Their numbers.
        points : ndarray, shape (n, 3)
            Their coordinates.
        """
        self.mesh.nodes.update(zip(labels, map(tuple, points.tolist()), strict=True))

    def coordinates(self, labels: list[int]) -> Array:
        """Return the coordinates of nodes.

        Parameters
        ----------
        labels : list of int
            Their numbers.

        Returns
        -------
        ndarray, shape (n, 3)
            Their coordinates.

        Raises
        ------
        ValueError
            If a node does not exist yet.
        """
        for label in labels:
            if label not in self.mesh.nodes:
                raise ValueError(f"node {label} is not defined before this line")
        return np.array([self.mesh.nodes[label] for label in labels], dtype=np.float64).reshape(-1, 3)
