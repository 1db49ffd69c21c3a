"""The parts and instances of an Abaqus model, placed, with their sets and surfaces under final names."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats._coordinates import Array, rotated
from fedic.io.mesh_formats._labelled_mesh import Numbering
from fedic.io.mesh_formats.abaqus.container import Container, SetBlock, SurfaceBlock
from fedic.io.mesh_formats.abaqus.sets import SetResolver
from fedic.io.mesh_formats.abaqus.surfaces import surface_cells

__all__ = ["Naming", "piece_contents"]


@dataclass
class Naming:
    """How the sets of a piece are called.

    Attributes
    ----------
    main : bool
        True if the piece is the only one with surface elements, so that its sets keep their names.
    outer_sets, outer_surfaces : list
        Those of the assembly.
    instances : tuple of str
        Names of all instances in capitals.
    """

    main: bool
    outer_sets: list[SetBlock]
    outer_surfaces: list[SurfaceBlock]
    instances: tuple[str, ...]


def piece_contents(path: Path, piece: Container, naming: Naming, *, keep_apart: bool) -> MeshFile:
    """Return the contents of a part or instance in the coordinates of the assembly.

    Parameters
    ----------
    path : Path
        The file, for error messages.
    piece : Container
        The part or instance, with the nodes, elements and sets of its part.
    naming : Naming
        How its sets are called.
    keep_apart : bool
        True if rigid elements are no part of the mesh as a whole.

    Returns
    -------
    MeshFile
        A piece that is not the main one has its sets as ``PIECE.SET`` and its cells as the set ``PIECE``. Of the main
        piece these are further names, in `MeshFile.parts`.

    Raises
    ------
    MeshError
        If an element refers to a node that does not exist, or a set to a set that does not exist.
    """
    mesh = piece.mesh
    resolver = SetResolver(mesh, [*piece.sets, *naming.outer_sets], piece.name.upper(), naming.instances)
    prefix = f"{piece.name}." if piece.name and not naming.main else ""
    sets = {}
    for kind in ("node", "element"):
        names = resolver.names(kind).items()
        sets[kind] = {
            (name if outer else prefix + name): resolver.members(kind, own, outer) for name, (outer, own) in names
        }
    whole = [name for name in dict.fromkeys((piece.name, piece.part)) if name]
    named_whole = whole[:1] if prefix else []
    sets["element"].update(dict.fromkeys(named_whole, resolver.existing["element"]))
    contents = mesh.contents(path, sets["node"], sets["element"], keep_apart=keep_apart)
    nodes = Numbering(mesh.node_labels())
    for surface in [*piece.surfaces, *naming.outer_surfaces]:
        cells = surface_cells(resolver, surface, nodes)
        if cells:
            contents.surfaces.setdefault(surface.name if surface.outer else prefix + surface.name, cells)
    if naming.main:
        _add_further_names(contents, whole)
    contents.points = _placed(piece, contents.points)
    return contents


def _add_further_names(contents: MeshFile, pieces: list[str]) -> None:
    """Name what the only piece holds by the names of the piece too: ``PLATE-1``, ``PLATE-1.LEFT``."""
    surfaces = dict(contents.surfaces)
    for piece in pieces:
        contents.parts[piece] = [np.arange(len(nodes)) for _, nodes in contents.blocks]
        contents.parts.update({f"{piece}.{name}": members for name, members in contents.cell_sets.items()})
        contents.surfaces.update({f"{piece}.{name}": cells for name, cells in surfaces.items()})


def _placed(piece: Container, points: Array) -> Array:
    """Return points moved, then turned, as the data lines of ``*INSTANCE`` say."""
    for line, numbers in piece.placement:
        with line.reported("*INSTANCE"):
            if len(numbers) <= 3:
                points = points + np.array(numbers + [0.0] * (3 - len(numbers)))
            elif len(numbers) == 7:
                a, b = np.array(numbers[:3]), np.array(numbers[3:6])
                points = rotated(points, a, b, numbers[6]) if numbers[6] else points
            else:
                raise ValueError(f"{len(numbers)} numbers, where a shift has 3 and a rotation 7")
    return points
