"""Keywords that define elements: ``*ELEMENT``, ``*ELGEN`` and ``*ELCOPY``."""

import numpy as np

from fedic._core import CELL_TYPES
from fedic.io.mesh_formats._labelled_mesh import Element
from fedic.io.mesh_formats._numbers import checked_label, integer, label
from fedic.io.mesh_formats.abaqus.blocks import Block
from fedic.io.mesh_formats.abaqus.container import Container
from fedic.io.mesh_formats.abaqus.elements import ElementType, element_type
from fedic.io.mesh_formats.abaqus.lines import Line, number_table
from fedic.io.mesh_formats.abaqus.node_commands import add_set
from fedic.io.mesh_formats.abaqus.sets import members_so_far

__all__ = ["copy_elements", "define_elements", "generate_elements"]


def define_elements(container: Container, block: Block) -> None:
    """Define the elements of an ``*ELEMENT`` block; of one given twice the last counts, as in Abaqus.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block.

    Raises
    ------
    MeshError
        If a line cannot be understood, or an element has too many or too few nodes.
    """
    name = block.parameters.get("TYPE", "")
    if not name:
        raise block.line.error("*ELEMENT needs the element type: *ELEMENT, TYPE=CPS4, for instance.")
    kind = element_type(name)
    if kind is None:
        container.mesh.others.setdefault(name)
        return
    for parameter in ("FILE", "OFFSET", "SOLIDELEMENTNUMBERING"):
        if parameter in block.parameters:
            raise block.line.error(f"the parameter {parameter} of *ELEMENT is not read for {name} elements; remove it.")
    table = number_table(block.data, np.int64)
    if table is not None and table.shape[1] == len(kind.nodes) + 1 and (table > 0).all():
        members = table[:, 0].tolist()
        nodes = table[:, 1:][:, kind.nodes].tolist()
        container.mesh.elements.update(
            (number, Element(kind.cell, tuple(row), kind.apart)) for number, row in zip(members, nodes, strict=True)
        )
    else:
        members = _elements(container, name, kind, block)
    add_set(container, "element", block.parameters.get("ELSET", ""), block.line, members)


def _elements(container: Container, name: str, kind: ElementType, block: Block) -> list[int]:
    """Define elements line by line; return their numbers."""
    members = []
    items: list[str] = []
    begin = block.line
    for line in block.data:
        begin, before = (begin, items) if items else (line, [])
        items = before + line.items()
        if before and len(items) > len(kind.nodes) + 1:
            items = before
            break
        if len(items) > len(kind.nodes) or kind.more:
            members.append(_define(container, name, kind, begin, items))
            items = []
    if items:
        raise begin.error(f"element {items[0]} has {len(items) - 1} nodes; {name} has {len(kind.nodes)}.")
    return members


def _define(container: Container, name: str, kind: ElementType, line: Line, items: list[str]) -> int:
    with line.reported("*ELEMENT"):
        element, *nodes = (label(item) for item in items)
    if len(nodes) < len(kind.nodes) or (len(nodes) > len(kind.nodes) and not kind.more):
        raise line.error(f"element {element} has {len(nodes)} nodes; {name} has {len(kind.nodes)}.")
    container.mesh.elements[element] = Element(kind.cell, tuple(nodes[place] for place in kind.nodes), kind.apart)
    return element


def generate_elements(container: Container, block: Block) -> None:
    """Generate elements in rows and layers by ``*ELGEN``.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block.

    Raises
    ------
    MeshError
        If a line cannot be understood, or the first element does not exist.
    """
    members = []
    for line in block.data:
        with line.reported("*ELGEN"):
            items = line.items()
            if len(items) > 10:
                raise ValueError(f"{len(items)} numbers, where 10 are known")
            master = label(items[0])
            numbers = [integer(item) if item else 1 for item in items[1:]] + [1] * (10 - len(items))
            counts, node_steps, steps = numbers[0::3], numbers[1::3], numbers[2::3]
            if min(counts) < 1:
                raise ValueError("a number of elements is not positive")
            container.budget.spend(counts[0] * counts[1] * counts[2])
            if master not in container.mesh.elements:
                if container.mesh.others:
                    continue
                raise ValueError(f"element {master} is not defined before this line")
            element = container.mesh.elements[master]
            for k in range(counts[2]):
                for j in range(counts[1]):
                    for i in range(counts[0]):
                        at = master + i * steps[0] + j * steps[1] + k * steps[2]
                        shift = i * node_steps[0] + j * node_steps[1] + k * node_steps[2]
                        members.append(at)
                        _add_shifted(container, at, element, shift)
    add_set(container, "element", block.parameters.get("ELSET", ""), block.line, members)


def copy_elements(container: Container, block: Block) -> None:
    """Copy the elements of a set by ``*ELCOPY``, on nodes of other numbers.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block.

    Raises
    ------
    MeshError
        If a parameter cannot be understood, or volume elements are reflected.
    """
    parameters = block.parameters
    with block.line.reported("*ELCOPY"):
        change, shift = (integer(parameters.get(name, "")) for name in ("ELEMENTSHIFT", "SHIFTNODES"))
        members, originals = [], members_so_far(container, "element", parameters.get("OLDSET", ""))
        container.budget.spend(len(originals))
        for each in originals:
            element = container.mesh.elements[each]
            if "REFLECT" in parameters and element.cell not in CELL_TYPES:
                raise ValueError(f"REFLECT is read for surface elements only; element {each} is none")
            members.append(each + change)
            _add_shifted(container, each + change, element, shift)
    add_set(container, "element", parameters.get("NEWSET", ""), block.line, members)


def _add_shifted(container: Container, at: int, element: Element, shift: int) -> None:
    nodes = tuple(node + shift for node in element.nodes)
    for number in (at, min(nodes), max(nodes)):
        checked_label(number)
    container.mesh.elements[at] = element._replace(nodes=nodes)
