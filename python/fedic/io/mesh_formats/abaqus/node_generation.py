"""Keywords that make nodes from nodes: ``*NGEN``, ``*NFILL``, ``*NCOPY`` and ``*NMAP``."""

import numpy as np

from fedic.io.mesh_formats._coordinates import Array, axes, from_cylindrical, rotated
from fedic.io.mesh_formats._numbers import checked_label, integer, label, real
from fedic.io.mesh_formats.abaqus.blocks import Block
from fedic.io.mesh_formats.abaqus.container import Container
from fedic.io.mesh_formats.abaqus.geometry import arc, reflected
from fedic.io.mesh_formats.abaqus.lines import Line
from fedic.io.mesh_formats.abaqus.node_commands import add_set, cartesian, reals, to_global
from fedic.io.mesh_formats.abaqus.sets import members_so_far

__all__ = ["copy_nodes", "fill_nodes", "generate_nodes", "map_nodes"]


def generate_nodes(container: Container, block: Block) -> None:
    """Generate nodes on lines and circular arcs by ``*NGEN``.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block.

    Raises
    ------
    MeshError
        If a line cannot be understood, or the curve is a parabola.
    """
    curve = block.parameters.get("LINE", "").upper()
    if curve not in ("", "C"):
        raise block.line.error(f"*NGEN, LINE={curve} is not read: fedic knows straight lines and circular arcs (C).")
    members: list[int] = []
    for line in block.data:
        with line.reported("*NGEN"):
            items = line.items()
            first, last = label(items[0]), label(items[1] if len(items) > 1 else "")
            step = integer(items[2]) if len(items) > 2 and items[2] else 1
            labels = _between(first, last, step)
            container.budget.spend(len(labels))
            ends = container.coordinates([first, last])
            shares = np.arange(1, len(labels) + 1) / (len(labels) + 1)
            if curve:
                points = arc(ends, _centre(container, block, line), _normal(line), shares)
            else:
                points = ends[0] + np.outer(shares, ends[1] - ends[0])
        container.add_nodes(list(labels), points)
        members += [first, *labels, last]
    add_set(container, "node", block.parameters.get("NSET", ""), block.line, members)


def fill_nodes(container: Container, block: Block) -> None:
    """Generate nodes between the nodes of two sets by ``*NFILL``.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block.

    Raises
    ------
    MeshError
        If a line cannot be understood.
    """
    for name in ("SINGULAR", "TWOSTEP"):
        if name in block.parameters:
            raise block.line.error(f"*NFILL, {name} is not read; export the mesh with all of its nodes.")
    members: list[int] = []
    for line in block.data:
        with line.reported("*NFILL"):
            bias = real(block.parameters["BIAS"]) if "BIAS" in block.parameters else 1.0
            first, last, *counts = line.items()
            pairs = list(zip(*(members_so_far(container, "node", name) for name in (first, last)), strict=False))
            intervals = integer(counts[0]) if counts else 0
            step = integer(counts[1]) if len(counts) > 1 and counts[1] else 1
            if intervals < 1 or bias <= 0.0:
                raise ValueError("the number of intervals and the bias are not positive")
            container.budget.spend(intervals * len(pairs))
            for start, end in pairs:
                if end - start != step * intervals:
                    raise ValueError(
                        f"nodes {start} and {end} do not differ by {intervals} intervals times the increment {step}"
                    )
            starts, ends = (
                (container.coordinates(list(side)) for side in zip(*pairs, strict=True)) if pairs else ((), ())
            )
            shares = np.cumsum(bias ** -np.arange(intervals, dtype=np.float64))
        for index, (start, end) in enumerate(pairs):
            labels = _between(start, end, step)
            between = np.outer(shares[:-1] / shares[-1], ends[index] - starts[index])
            container.add_nodes(list(labels), starts[index] + between)
            members += [start, *labels, end]
    add_set(container, "node", block.parameters.get("NSET", ""), block.line, members)


def copy_nodes(container: Container, block: Block) -> None:
    """Copy the nodes of a set by ``*NCOPY``, shifted and turned, or reflected.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block.

    Raises
    ------
    MeshError
        If a line cannot be understood, or the nodes are projected from a pole.
    """
    parameters, data = block.parameters, block.data
    if "POLE" in parameters:
        raise block.line.error("*NCOPY, POLE is not read; export the mesh with all of its nodes.")
    with (data[0] if data else block.line).reported("*NCOPY"):
        old = members_so_far(container, "node", parameters.get("OLDSET", ""))
        change = integer(parameters.get("CHANGENUMBER", ""))
        times = integer(parameters.get("MULTIPLE", "1"))
        container.budget.spend(times * len(old))
        points, new = container.coordinates(old), list[int]()
        if "REFLECT" in parameters:
            given = np.array([real(item) for line in data for item in line.items() if item])
            copies = [reflected(points, parameters["REFLECT"].upper(), given)]
        elif "SHIFT" in parameters and data:
            shift, turn = reals(data[0], 3), reals(data[1], 7) if len(data) > 1 else np.zeros(7)
            if times > 1 and shift.any() and turn[6]:
                raise ValueError("several copies that are both shifted and turned are not read")
            copies = []
            for _ in range(times):
                points = points + shift
                points = rotated(points, turn[:3], turn[3:6], turn[6]) if turn[6] else points
                copies.append(points)
        else:
            raise ValueError("neither SHIFT with data lines nor REFLECT is given")
        for index, copied in enumerate(copies, start=1):
            labels = [checked_label(each + index * change) for each in old]
            container.add_nodes(labels, copied)
            new += labels
    add_set(container, "node", parameters.get("NEWSET", ""), block.line, new)


def map_nodes(container: Container, block: Block) -> None:
    """Map the nodes of a set from a rectangular or cylindrical system by ``*NMAP``.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block.

    Raises
    ------
    MeshError
        If a line cannot be understood, or the map is another.
    """
    kind, definition = (block.parameters.get(name, "").upper() for name in ("TYPE", "DEFINITION"))
    if kind not in ("RECTANGULAR", "CYLINDRICAL") or definition not in ("", "COORDINATES"):
        raise block.line.error(
            f"*NMAP, TYPE={kind} is not read: fedic knows RECTANGULAR and CYLINDRICAL by coordinates; "
            "export the mesh as it results."
        )
    with (block.data[0] if block.data else block.line).reported("*NMAP"):
        if not block.data:
            raise ValueError("the points of the system are missing")
        labels = members_so_far(container, "node", block.parameters.get("NSET", ""))
        given = reals(block.data[0], 6)
        origin, scale = given[:3], np.ones(3)
        turn = np.eye(3)
        if len(block.data) > 1:
            second = reals(block.data[1], 3) - origin
            turn = axes(given[3:] - origin, second)
        elif kind == "CYLINDRICAL" or given[3:].any():
            raise ValueError("the line of the third point is missing")
        if len(block.data) > 2:
            scale = reals(block.data[2], 3)
            scale[scale == 0.0] = 1.0
        points = container.coordinates(labels) * scale
        if kind == "CYLINDRICAL":
            # The first axis of the points is the height, the second the direction of angle zero.
            points = np.roll(from_cylindrical(points), 1, axis=1)
        container.add_nodes(labels, points @ turn + origin)


def _between(first: int, last: int, step: int) -> range:
    """Return the numbers between two ends."""
    if step == 0 or (last - first) % step or (last - first) // step < 1:
        raise ValueError(f"the numbers {first} and {last} do not differ by a multiple of {step}")
    return range(first + step, last, step)


def _centre(container: Container, block: Block, line: Line) -> Array:
    items = [*line.items(), *[""] * 10]
    if items[3]:
        (centre,) = container.coordinates([label(items[3])])
        return np.asarray(centre)
    if not any(items[4:7]):
        raise ValueError("the centre of the circle is missing")
    given = np.array([[real(item) if item else 0.0 for item in items[4:7]]])
    return np.asarray(to_global(container, cartesian(given, block))[0])


def _normal(line: Line) -> Array:
    items = [*line.items(), *[""] * 10]
    return np.array([real(item) if item else 0.0 for item in items[7:10]])
