"""Keywords that define nodes: ``*NODE`` and ``*SYSTEM``."""

import numpy as np

from fedic.io.mesh_formats._coordinates import Array, axes, from_cylindrical
from fedic.io.mesh_formats._numbers import label, real
from fedic.io.mesh_formats.abaqus.blocks import Block
from fedic.io.mesh_formats.abaqus.container import Container, SetBlock
from fedic.io.mesh_formats.abaqus.lines import Line, number_table

__all__ = ["add_set", "cartesian", "define_nodes", "define_system", "reals", "to_global"]

_MAX_FIELDS = 7
_EXACT = 2**53


def define_nodes(container: Container, block: Block) -> None:
    """Define the nodes of a ``*NODE`` block; fields that are left blank are zero.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block.

    Raises
    ------
    MeshError
        If a line cannot be understood, or the coordinate system is not known.
    """
    labels, local = _plain_nodes(block.data) or _nodes(block.data)
    container.add_nodes(labels, to_global(container, cartesian(local, block)))
    add_set(container, "node", block.parameters.get("NSET", ""), block.line, labels)


def _plain_nodes(lines: list[Line]) -> tuple[list[int], Array] | None:
    """Return numbers and coordinates of nodes if all lines are alike, in two or three plain coordinates."""
    table = number_table(lines, np.float64)
    if table is None or table.shape[1] not in (3, 4) or not np.isfinite(table).all():
        return None
    labels = table[:, 0]
    if (labels < 1).any() or (labels > _EXACT).any() or (labels % 1 != 0).any():
        return None
    points = np.zeros((len(table), 3))
    points[:, : table.shape[1] - 1] = table[:, 1:]
    return labels.astype(np.int64).tolist(), points


def _nodes(lines: list[Line]) -> tuple[list[int], Array]:
    """Return numbers and coordinates of nodes, line by line."""
    labels, points = [], []
    for line in lines:
        with line.reported("*NODE"):
            first, *fields = line.items()
            if len(fields) >= _MAX_FIELDS:
                raise ValueError(f"{len(fields) + 1} fields, more than a number, 3 coordinates and 3 of a normal")
            labels.append(label(first))
            points.append(([real(field) if field else 0.0 for field in fields] + [0.0, 0.0, 0.0])[:3])
    return labels, np.array(points, dtype=np.float64).reshape(-1, 3)


def define_system(container: Container, block: Block) -> None:
    """Take over the coordinate system of a ``*SYSTEM`` block, in which the nodes that follow are given.

    Parameters
    ----------
    container : Container
        The part.
    block : Block
        The block; without data lines it ends the system.

    Raises
    ------
    MeshError
        If the points do not define a system.
    """
    container.system = None
    if not block.data:
        return
    line = block.data[0]
    with line.reported("*SYSTEM"):
        given = reals(line, 6)
        origin = given[:3]
        if len([item for item in line.items()[3:] if item]) == 0 and len(block.data) == 1:
            container.system = (origin, np.eye(3))
            return
        first = given[3:] - origin
        if len(block.data) == 1:
            first[2] = 0.0
            second = np.array([-first[1], first[0], 0.0])
        else:
            second = reals(block.data[1], 3) - origin
        container.system = (origin, axes(first, second))


def cartesian(points: Array, block: Block) -> Array:
    """Return Cartesian coordinates of points given in the system of the parameter ``SYSTEM``.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Coordinates as given.
    block : Block
        The block with the parameter.

    Returns
    -------
    ndarray, shape (n, 3)
        Cartesian coordinates.

    Raises
    ------
    MeshError
        If the system is spherical or unknown.
    """
    system = block.parameters.get("SYSTEM", "R").upper()
    if system in ("R", "RC") or (system and "RECTANGULAR".startswith(system)):
        return points
    if system and "CYLINDRICAL".startswith(system):
        return from_cylindrical(points)
    raise block.line.error(
        f"*{block.keyword}, SYSTEM={system} is not read: fedic knows rectangular (R) and cylindrical (C) coordinates; "
        "give the nodes in one of these."
    )


def to_global(container: Container, points: Array) -> Array:
    """Return points in the part's coordinates, given in those of its ``*SYSTEM``.

    Parameters
    ----------
    container : Container
        The part.
    points : ndarray, shape (n, 3)
        Cartesian coordinates in the system.

    Returns
    -------
    ndarray, shape (n, 3)
        Coordinates in the part.
    """
    if container.system is None:
        return points
    origin, rows = container.system
    return points @ rows + origin


def add_set(container: Container, kind: str, name: str, line: Line, labels: list[int]) -> None:
    """Add nodes or elements to a set that a keyword names.

    Parameters
    ----------
    container : Container
        The part.
    kind : str
        ``"node"`` or ``"element"``.
    name : str
        Name of the set; nothing is done if it is empty.
    line : Line
        The keyword line.
    labels : list of int
        The numbers.
    """
    if name:
        members = np.array(labels, dtype=np.int64)
        container.sets.append(SetBlock(kind, name, line, [members], outer=container.kind == "ASSEMBLY"))


def reals(line: Line, count: int) -> Array:
    """Return the numbers of a line; those that are left blank are zero.

    Parameters
    ----------
    line : Line
        The line.
    count : int
        How many numbers there may be.

    Returns
    -------
    ndarray, shape (count,)
        The numbers.

    Raises
    ------
    ValueError
        If there are more numbers, or an item is no number.
    """
    items = line.items()
    if len(items) > count:
        raise ValueError(f"{len(items)} numbers, where {count} are known")
    return np.array([real(item) if item else 0.0 for item in items] + [0.0] * (count - len(items)))
