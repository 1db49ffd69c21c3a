"""Elements of Nastran and OptiStruct."""

from typing import NamedTuple

from fedic.io.mesh_formats._labelled_mesh import Element
from fedic.io.mesh_formats.nastran.cards import Card

__all__ = ["element_of"]


class _Kind(NamedTuple):
    """Cell types of a card by number of nodes, and the places on the card of the cell's nodes, if in another order."""

    cells: dict[int, str]
    order: tuple[int, ...] = ()


_TRIANGLE = _Kind({3: "triangle"})
_TRIANGLE6 = _Kind({3: "triangle", 6: "triangle6"})
_QUAD = _Kind({4: "quad"})
_QUAD8 = _Kind({4: "quad", 8: "quad8"})
_LINE = _Kind({2: "line"})
_KINDS = {
    **dict.fromkeys(("CTRIA3", "CTRIAR", "CPLSTN3", "CPLSTS3", "CTRAX3"), _TRIANGLE),
    **dict.fromkeys(("CTRIA6", "CPLSTN6", "CPLSTS6", "CTRIAX", "CTRAX6"), _TRIANGLE6),
    **dict.fromkeys(("CQUAD4", "CQUADR", "CSHEAR", "CPLSTN4", "CPLSTS4", "CQUADX4"), _QUAD),
    **dict.fromkeys(("CQUAD8", "CPLSTN8", "CPLSTS8", "CQUADX8"), _QUAD8),
    **dict.fromkeys(("CQUAD", "CQUADX"), _Kind({4: "quad", 8: "quad8", 9: "quad9"})),
    "CTRIAX6": _Kind({3: "triangle", 6: "triangle6"}, (0, 2, 4, 1, 3, 5)),
    "CTETRA": _Kind({4: "tetra", 10: "tetra10"}),
    **dict.fromkeys(("CPYRAM", "CPYRA"), _Kind({5: "pyramid", 13: "pyramid13"})),
    "CPENTA": _Kind({6: "wedge", 15: "wedge15"}, (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11)),
    "CHEXA": _Kind({8: "hexahedron", 20: "hexahedron20"}, (*range(12), 16, 17, 18, 19, 12, 13, 14, 15)),
    **dict.fromkeys(("CROD", "CTUBE", "CBAR", "CBEAM", "CBEND"), _LINE),
}


def element_of(card: Card) -> Element | None:
    """Return the element of a card; None if the card is no element that fedic uses.

    Parameters
    ----------
    card : Card
        The card.

    Returns
    -------
    Element or None
        The element. Nodes in the middle of edges are given all or not at all.

    Raises
    ------
    MeshError
        If nodes are missing.
    """
    kind = _KINDS.get(card.name)
    if kind is None:
        return None
    most = max(kind.cells)
    fields = card.fields[2 : 2 + most]
    places = kind.order or range(most)
    given = [place < len(fields) and fields[place] not in ("", "0") for place in places]
    for count in sorted(kind.cells, reverse=True):
        if all(given[:count]) and not any(given[count:]):
            return Element(kind.cells[count], tuple([card.label(3 + place) for place in places[:count]]))
    card.label(1)
    missing = sorted(place + 1 for place, there in zip(places, given, strict=True) if not there)
    advice = "give all nodes in the middle of edges, or none" if len(kind.cells) > 1 else "complete the card"
    raise card.error(
        f"the {card.name} element {card.text(1)} lacks the nodes {', '.join(map(str, missing))} of {most}; {advice}."
    )
