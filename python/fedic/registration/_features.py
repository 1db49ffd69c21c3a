"""Named parts of a mesh's boundary: straight sides, circles, arcs, whole loops."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.errors import OptionError
from fedic.registration._boundary import boundary_loops
from fedic.registration._pieces import Circle, Piece, cut_loop

__all__ = ["BoundaryFeature", "Kind", "boundary_features", "chosen_features", "listed_features"]

Kind: TypeAlias = Literal["side", "circle", "arc", "loop"]
_SIDES = ("right", "top", "left", "bottom")


@dataclass(frozen=True, eq=False)
class BoundaryFeature:
    """A named part of the boundary of a mesh.

    Attributes
    ----------
    name : str
        Name, such as ``"left"`` or ``"hole 0"``.
    kind : {"side", "circle", "arc", "loop"}
        Straight side, whole circle, arc of a circle, or any closed loop.
    nodes : ndarray of int, shape (n,)
        Its nodes in order, the material on the left.
    length : float
        Length in the mesh's unit.
    description : str
        Position and size in words.
    pieces : tuple of Piece
        Its lines and arcs; one unless it is a loop.
    """

    name: str
    kind: Kind
    nodes: NDArray[np.int64]
    length: float
    description: str
    pieces: tuple[Piece, ...]

    def __repr__(self) -> str:
        return f"BoundaryFeature({self.name!r}: {self.description}, {len(self.nodes)} nodes)"


def boundary_features(mesh: Mesh) -> list[BoundaryFeature]:
    """List the parts of a mesh's boundary that `fedic.register` can fit to an image.

    Each loop of the boundary is cut at its corners and at the ends of its arcs. The straight sides of the outer
    boundary are named ``left``, ``right``, ``bottom`` and ``top``, with X to the right and Y upwards, and numbered if
    several face the same way; its arcs are ``arc 0``, ``arc 1``, ...; the whole of it is ``outline``. Holes are ``hole
    0``, ``hole 1``, ... from left to right; the parts of one that is not a circle are ``hole 0 left``, ...

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    list of BoundaryFeature
        Sides, then arcs, then whole loops of the outer boundary; then the holes.
    """
    points = mesh.points
    size = float(np.linalg.norm(np.ptp(points[mesh.used_nodes, :2], axis=0)))
    loops = boundary_loops(mesh)
    holes = [loop for loop in loops if loop.area < 0.0]
    outer = [loop for loop in loops if loop.area >= 0.0]
    found: list[BoundaryFeature] = []
    for group, word in ((outer, "outline"), (holes, "hole")):
        for index, loop in enumerate(group):
            name = f"{word} {index}" if word == "hole" or len(group) > 1 else word
            prefix = "" if name == "outline" else f"{name} "
            pieces = cut_loop(loop.segments, points, size)
            if not pieces[0].closed:
                found += _named_pieces(pieces, points, prefix, inwards=word == "hole")
            found.append(_loop_feature(name, pieces, points))
    return found


def chosen_features(mesh: Mesh, wanted: Sequence[str | BoundaryFeature]) -> list[BoundaryFeature]:
    """Look up features by name.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    wanted : sequence of str or BoundaryFeature
        Names, or features of this mesh.

    Returns
    -------
    list of BoundaryFeature
        The features, in the order given.

    Raises
    ------
    OptionError
        If a name is unknown or given twice; the message lists the names.
    """
    if isinstance(wanted, str) or not all(isinstance(each, (str, BoundaryFeature)) for each in wanted):
        raise OptionError(
            f"features={wanted!r}: give a list of names or of features of fedic.boundary_features(mesh).", "features"
        )
    known = {feature.name: feature for feature in boundary_features(mesh)}
    chosen = []
    for each in wanted:
        if isinstance(each, str) and each not in known:
            raise OptionError(
                f"features: the mesh has no boundary part {each!r}; it has{listed_features(mesh)}", "features"
            )
        feature = known[each] if isinstance(each, str) else each
        if feature.nodes.max() >= mesh.num_nodes:
            raise OptionError(
                f"features: {feature.name!r} has nodes that are not in this mesh; it is a feature of another mesh.",
                "features",
            )
        chosen.append(feature)
    twice = [name for name, count in Counter(feature.name for feature in chosen).items() if count > 1]
    if twice:
        raise OptionError(f"features: {twice[0]!r} is given twice.", "features")
    return chosen


def listed_features(mesh: Mesh) -> str:
    """Return the features of a mesh for a message, one per line."""
    return "".join(f"\n  {feature.name}: {feature.description}" for feature in boundary_features(mesh))


def _named_pieces(pieces: list[Piece], points: Floats, prefix: str, *, inwards: bool) -> list[BoundaryFeature]:
    """Name the pieces of a loop, sides before arcs."""
    facing = ["arc" if piece.circle else _facing(piece, points, inwards=inwards) for piece in pieces]
    found = []
    for word in ("left", "right", "bottom", "top", "arc"):
        members = [piece for piece, side in zip(pieces, facing, strict=True) if side == word]
        if word != "arc":
            axis = 1 if word in ("left", "right") else 0
            members.sort(key=lambda piece: float(points[piece.segments[:, 0], axis].mean()))
        for index, piece in enumerate(members):
            name = f"{prefix}{word}" if len(members) == 1 and word != "arc" else f"{prefix}{word} {index}"
            found.append(_piece_feature(name, piece, points))
    return found


def _facing(piece: Piece, points: Floats, *, inwards: bool) -> str:
    """Return the side of its loop on which a straight piece lies, from its normal out of the material or the hole."""
    along = points[piece.segments[-1, 2], :2] - points[piece.segments[0, 0], :2]
    normal = np.array([along[1], -along[0]]) * (-1.0 if inwards else 1.0)
    quarter = round(float(np.arctan2(normal[1], normal[0])) / (0.5 * np.pi)) % 4
    return _SIDES[quarter]


def _piece_feature(name: str, piece: Piece, points: Floats) -> BoundaryFeature:
    length = _length(piece, points)
    if piece.circle is None:
        ends = [_written(points[node, :2]) for node in (piece.segments[0, 0], piece.segments[-1, 2])]
        return BoundaryFeature(name, "side", _in_order(piece), length, f"straight, {ends[0]} to {ends[1]}", (piece,))
    text = f"arc about {_written(piece.circle.centre)}, radius {piece.circle.radius:.4g}"
    return BoundaryFeature(name, "arc", _in_order(piece), length, text, (piece,))


def _loop_feature(name: str, pieces: list[Piece], points: Floats) -> BoundaryFeature:
    nodes = np.concatenate([_in_order(piece)[:-1] for piece in pieces])
    length = sum(_length(piece, points) for piece in pieces)
    circle: Circle | None = pieces[0].circle if pieces[0].closed else None
    if circle is not None:
        text = f"circle about {_written(circle.centre)}, radius {circle.radius:.4g}"
        return BoundaryFeature(name, "circle", nodes, length, text, tuple(pieces))
    text = f"closed, around {_written(points[nodes, :2].mean(axis=0))}, length {length:.4g}"
    return BoundaryFeature(name, "loop", nodes, length, text, tuple(pieces))


def _length(piece: Piece, points: Floats) -> float:
    nodes = _in_order(piece)
    return float(np.linalg.norm(np.diff(points[nodes], axis=0), axis=1).sum())


def _in_order(piece: Piece) -> NDArray[np.int64]:
    nodes = np.append(piece.segments[:, :2].ravel(), piece.segments[-1, 2])
    return nodes[nodes >= 0]


def _written(point: Floats) -> str:
    return f"({point[0]:.4g}, {point[1]:.4g})"
