"""Node and element sets of Abaqus."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from fedic.errors import MeshError
from fedic.io.mesh_formats._labelled_mesh import LabelledMesh, Labels
from fedic.io.mesh_formats._numbers import integer, label
from fedic.io.mesh_formats.abaqus.blocks import Block
from fedic.io.mesh_formats.abaqus.container import Container, SetBlock
from fedic.io.mesh_formats.abaqus.lines import Line

__all__ = ["SetResolver", "members_so_far", "read_set"]

MAX_NESTED = 100
"""Largest number of sets that contain each other in a chain."""
_NONE = np.empty(0, dtype=np.int64)


def read_set(block: Block, outer: bool) -> SetBlock:
    """Return the set of a ``*NSET`` or ``*ELSET`` block.

    Parameters
    ----------
    block : Block
        The block.
    outer : bool
        True in the assembly.

    Returns
    -------
    SetBlock
        The set.

    Raises
    ------
    MeshError
        If the set has no name, or a line cannot be understood.
    """
    keyword, parameters = block.keyword, block.parameters
    if not parameters.get(keyword):
        raise block.line.error(f"*{keyword} needs the name of the set: *{keyword}, {keyword}=name.")
    found = SetBlock("node" if keyword == "NSET" else "element", parameters[keyword], block.line)
    found.outer, found.instance = outer, parameters.get("INSTANCE", "").upper()
    found.unsorted = "UNSORTED" in parameters
    if keyword == "NSET":
        found.of_elements = parameters.get("ELSET", "")
    for line in block.data:
        if "GENERATE" in parameters:
            found.items.append(_range(line, found.name))
        else:
            with line.reported(f"*{keyword}"):
                items = [item for item in line.items() if item]
                names = [item.strip('"').strip() for item in items if not _is_number(item)]
                numbers = [label(item) for item in items if _is_number(item)]
            found.items.extend([*names, np.array(numbers, dtype=np.int64)])
    return found


def _is_number(text: str) -> bool:
    return text.isascii() and text.isdigit()


def _range(line: Line, name: str) -> range:
    try:
        first, last, *step = (integer(item) for item in line.items() if item)
        (increment,) = step or [1]
        if increment <= 0:
            raise ValueError
    except ValueError as error:
        raise line.error(f"the set {name} has a line that is not first, last, increment.") from error
    return range(first, last + 1, increment)


class SetResolver:
    """The sets of a part or instance, and those of the assembly as far as they lie in it.

    Numbers that the part does not have are ignored, as in Abaqus. Names are compared without case.

    Parameters
    ----------
    mesh : LabelledMesh
        Nodes and elements of the part.
    blocks : iterable of SetBlock
        Sets in the order of the file.
    instance : str
        Name of the instance in capitals.
    others : iterable of str
        Names of all instances in capitals.
    """

    def __init__(
        self, mesh: LabelledMesh, blocks: Iterable[SetBlock], instance: str = "", others: Iterable[str] = ()
    ) -> None:
        self.mesh, self.instance, self.others = mesh, instance, set(others)
        self.blocks: dict[tuple[str, bool, str], list[SetBlock]] = {}
        self.outer_names: set[tuple[str, str]] = set()
        for block in blocks:
            if block.outer:
                self.outer_names.add((block.kind, block.name.upper()))
            if not block.outer or block.instance in ("", instance):
                self.blocks.setdefault((block.kind, block.outer, block.name.upper()), []).append(block)
        self._known: dict[tuple[str, bool, str], Labels] = {}
        elements = np.fromiter(mesh.elements, dtype=np.int64, count=len(mesh.elements))
        self.existing = {"node": np.sort(mesh.node_labels()), "element": np.sort(elements)}

    def names(self, kind: str) -> dict[str, tuple[bool, str]]:
        """Return the sets of a kind: by the name to give them, whether they are of the assembly, and their own name.

        A set of the assembly whose name the part uses as well is called ``Assembly.NAME``.

        Parameters
        ----------
        kind : str
            ``"node"`` or ``"element"``.

        Returns
        -------
        dict of str to (bool, str)
            In the order of the file.
        """
        found = {}
        for (each, outer, key), blocks in self.blocks.items():
            if each == kind:
                name = blocks[0].name
                found[f"Assembly.{name}" if outer and (kind, False, key) in self.blocks else name] = (outer, name)
        return found

    def members(self, kind: str, name: str, outer: bool = False, referring: tuple[str, ...] = ()) -> Labels:
        """Return the numbers of the members of a set, in ascending order unless the set is ``UNSORTED``.

        Parameters
        ----------
        kind : str
            ``"node"`` or ``"element"``.
        name : str
            Name of the set.
        outer : bool
            True for a set of the assembly.
        referring : tuple of str
            The sets that led here.

        Returns
        -------
        ndarray of int
            Numbers that the part has; blocks of one name are joined.

        Raises
        ------
        MeshError
            If a set refers to one that does not exist, or to itself.
        """
        key = (kind, outer, name.upper())
        if key in self._known:
            return self._known[key]
        if len(referring) > MAX_NESTED:
            line = self.blocks[key][0].line
            raise line.error(f"sets contain each other over more than {MAX_NESTED} levels; give their members.")
        parts = [_NONE]
        for block in self.blocks[key]:
            if name.upper() in referring:
                raise MeshError(f"{block.line.source}: the {kind} set {name} contains itself.")
            chain = (*referring, name.upper())
            if block.of_elements:
                elements = self._named(block, "element", block.of_elements, chain)
                nodes = [self.mesh.elements[element].nodes for element in elements.tolist()]
                parts.append(np.array([node for each in nodes for node in each], dtype=np.int64))
            parts.extend(self._item_members(block, item, chain) for item in block.items)
        found = np.concatenate(parts)
        self._known[key] = found if any(block.unsorted for block in self.blocks[key]) else np.unique(found)
        return self._known[key]

    def _item_members(self, block: SetBlock, item: Labels | range | str, chain: tuple[str, ...]) -> Labels:
        if isinstance(item, str):
            return self._named(block, block.kind, item, chain)
        # A set of the assembly that names no instance holds numbers of the assembly's own nodes.
        if block.outer and not block.instance and self.instance:
            return _NONE
        labels = self.existing[block.kind]
        if not isinstance(item, range):
            return item[np.isin(item, labels)]
        inside: Labels = labels[(labels >= item.start) & (labels <= item.stop - 1)]
        chosen: Labels = inside[(inside - item.start) % item.step == 0]
        return chosen

    def element_labels(self, name: str, outer: bool) -> Labels:
        """Return the elements that a surface names: a set or a number, in the assembly also ``INSTANCE.SET``.

        Parameters
        ----------
        name : str
            The name or number; empty for all elements.
        outer : bool
            True in the assembly.

        Returns
        -------
        ndarray of int
            Numbers of elements that the part has; none if there is no such set.
        """
        if not name:
            return self.existing["element"]
        instance, dot, local = name.partition(".")
        if outer and dot and instance.upper() == self.instance:
            name, outer = local, False
        if ("element", outer, name.upper()) in self.blocks:
            return self.members("element", name, outer)
        if _is_number(name) and not (outer and self.instance):
            return np.intersect1d(self.existing["element"], [label(name)])
        return _NONE

    def _named(self, block: SetBlock, kind: str, name: str, chain: tuple[str, ...]) -> Labels:
        """Return the members of a set that a set names; in the assembly also ``INSTANCE.SET`` and ``INSTANCE.5``."""
        scopes = [False] if not block.outer else [False, True] if block.instance else [True]
        for outer in scopes:
            if (kind, outer, name.upper()) in self.blocks:
                return self.members(kind, name, outer, chain)
        instance, dot, local = name.partition(".")
        if block.outer and dot and instance.upper() in self.others:
            if instance.upper() != self.instance:
                return _NONE
            if _is_number(local):
                return self._item_members(replace(block, instance=self.instance), np.array([label(local)]), chain)
            if (kind, False, local.upper()) in self.blocks:
                return self.members(kind, local, False, chain)
        if (kind, name.upper()) in self.outer_names:
            return _NONE
        raise block.line.error(
            f"the set {block.name} contains {name!r}, which is neither a label nor a set of {kind}s."
        )


def members_so_far(container: Container, kind: str, name: str) -> list[int]:
    """Return the members of a set as it is at this place of the file.

    Parameters
    ----------
    container : Container
        The part.
    kind : str
        ``"node"`` or ``"element"``.
    name : str
        Name of the set.

    Returns
    -------
    list of int
        Their numbers, in the order of `SetResolver.members`.

    Raises
    ------
    ValueError
        If there is no such set yet.
    """
    resolver = SetResolver(container.mesh, container.sets)
    outer = container.kind == "ASSEMBLY"
    if (kind, outer, name.upper()) not in resolver.blocks:
        raise ValueError(f"the {kind} set {name!r} is not defined before this line")
    members: list[int] = resolver.members(kind, name, outer).tolist()
    return members
