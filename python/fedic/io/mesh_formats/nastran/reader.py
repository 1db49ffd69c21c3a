"""Meshes in the bulk data of Nastran and OptiStruct."""

from pathlib import Path

import numpy as np

from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats._coordinates import Array
from fedic.io.mesh_formats._labelled_mesh import LabelledMesh
from fedic.io.mesh_formats.nastran.cards import Card, read_cards
from fedic.io.mesh_formats.nastran.elements import element_of
from fedic.io.mesh_formats.nastran.systems import Systems

__all__ = ["read_nastran"]

_SYSTEMS = {f"CORD{number}{kind}" for number in "12" for kind in "RCS"}


def read_nastran(path: Path) -> MeshFile:
    """Read the nodes and elements of bulk data.

    Parameters
    ----------
    path : Path
        The file: ``.bdf``, ``.nas``, ``.fem``, ``.dat``.

    Returns
    -------
    MeshFile
        Nodes in the order of the file and in the basic coordinate system. The elements of each property are a set,
        ``PID 1`` for instance.

    Raises
    ------
    MeshError
        If a card cannot be understood, a node or element is defined twice in two ways, an element refers to a node that
        does not exist, or a node to a coordinate system that does not exist.
    """
    grids: dict[int, Card] = {}
    elements: dict[int, Card] = {}
    mesh = LabelledMesh()
    properties: dict[str, list[int]] = {}
    default_system = 0
    systems = Systems(lambda number, card: _node(number, card, grids, default_system, systems))
    makes_mesh = False
    for card in read_cards(path):
        if card.name.startswith("="):
            if makes_mesh:
                raise card.error("this card repeats the one before (=), which is not followed; write all cards out.")
            continue
        makes_mesh = card.name in {*_SYSTEMS, "GRID"}
        if card.name == "GRID":
            _add_once(grids, card)
        elif card.name == "GRDSET":
            default_system = card.integer(2, 0)
        elif card.name in _SYSTEMS:
            systems.add(card)
        elif (element := element_of(card)) is not None:
            makes_mesh = True
            if _add_once(elements, card):
                number = card.label(1)
                mesh.elements[number] = element
                if element.cell != "line" and card.text(2):
                    properties.setdefault(f"PID {card.label(2)}", []).append(number)
        elif card.name.startswith("C") and card.name[1:2].isalpha() and card.text(3):
            mesh.others.setdefault(card.name)
    points = _basic_points(grids, default_system, systems)
    mesh.nodes = dict(zip(grids, map(tuple, points.tolist()), strict=True))
    sets = {name: np.array(labels, dtype=np.int64) for name, labels in properties.items()}
    return mesh.contents(path, {}, sets, keep_apart=False)


def _add_once(cards: dict[int, Card], card: Card) -> bool:
    """Add a card under its number; return whether it was not there already."""
    number = card.label(1)
    earlier = cards.setdefault(number, card)
    if earlier is card:
        return True
    if (earlier.name, _stripped(earlier)) != (card.name, _stripped(card)):
        raise card.error(
            f"{card.name} {number} is defined a second time, not as in line {earlier.number}; remove one of the two."
        )
    return False


def _stripped(card: Card) -> list[str]:
    """Return the fields up to the last that is not blank."""
    last = max((place for place, field in enumerate(card.fields, start=1) if field), default=0)
    return card.fields[:last]


def _basic_points(grids: dict[int, Card], default_system: int, systems: Systems) -> Array:
    """Return the coordinates of all nodes in the basic system."""
    local = np.array([[card.real(place) for place in (3, 4, 5)] for card in grids.values()]).reshape(-1, 3)
    numbers = np.array([card.integer(2, default_system) for card in grids.values()], dtype=np.int64)
    cards = list(grids.values())
    points: Array = local.copy()
    for number in np.unique(numbers):
        members = np.flatnonzero(numbers == number)
        points[members] = systems.basic(int(number), local[members], cards[members[0]])
    return points


def _node(number: int, card: Card, grids: dict[int, Card], default_system: int, systems: Systems) -> Array:
    """Return a node by which a coordinate system is defined."""
    if number not in grids:
        raise card.error(f"{card.name} refers to node {number}, which the file does not define.")
    points = _basic_points({number: grids[number]}, default_system, systems)
    return np.asarray(points[0])
