"""Surface meshes in Abaqus input files."""

from dataclasses import replace
from pathlib import Path

from fedic.errors import MeshError
from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats._numbers import real
from fedic.io.mesh_formats.abaqus.blocks import Block, read_blocks
from fedic.io.mesh_formats.abaqus.container import Container
from fedic.io.mesh_formats.abaqus.element_commands import copy_elements, define_elements, generate_elements
from fedic.io.mesh_formats.abaqus.joined import joined
from fedic.io.mesh_formats.abaqus.node_commands import define_nodes, define_system
from fedic.io.mesh_formats.abaqus.node_generation import copy_nodes, fill_nodes, generate_nodes, map_nodes
from fedic.io.mesh_formats.abaqus.pieces import Naming, piece_contents
from fedic.io.mesh_formats.abaqus.sets import read_set
from fedic.io.mesh_formats.abaqus.surfaces import read_surface

__all__ = ["read_abaqus"]

MAX_SIZE = 20_000_000
"""Largest number of nodes and elements of all instances."""
_COMMANDS = {
    "NODE": define_nodes,
    "SYSTEM": define_system,
    "NGEN": generate_nodes,
    "NFILL": fill_nodes,
    "NCOPY": copy_nodes,
    "NMAP": map_nodes,
    "ELEMENT": define_elements,
    "ELGEN": generate_elements,
    "ELCOPY": copy_elements,
}


def read_abaqus(path: Path) -> MeshFile:
    """Read the nodes, elements, sets and named surfaces of an input file.

    Instances are placed as their data lines say. Nodes come in the order of the file: of a model of parts, instance by
    instance, each as in its part.

    Parameters
    ----------
    path : Path
        The ``.inp`` file.

    Returns
    -------
    MeshFile
        Surface elements (plane, axisymmetric, shell, membrane), volume elements and lines; others come under their
        Abaqus name, without nodes. If one instance has surface elements, its sets keep their names; if several have,
        ``INSTANCE.SET`` is a set of an instance and ``INSTANCE`` holds its cells. Sets of the assembly keep their
        names. ``MeshFile.surfaces`` holds what ``*SURFACE`` makes of element faces, and rigid elements beside
        deformable ones; ``MeshFile.parts`` holds the sets of the only instance as ``INSTANCE.SET`` and ``PART.SET``.
        Several parts without an assembly need a selection.

    Raises
    ------
    MeshError
        If a line cannot be understood, a keyword that changes the mesh is not known, an element refers to a node that
        does not exist, or a set to a set that does not exist.
    """
    containers = _read_containers(path)
    outside = [each for each in containers if each.kind == "ASSEMBLY"]
    instances = [_with_part(each, containers) for each in containers if each.kind == "INSTANCE"]
    pieces = instances or [each for each in containers if each.kind == "PART"]
    root = containers[0]
    if outside:
        # What follows the assembly, in the steps for instance, refers to the assembly.
        outside[0].sets += [replace(each, outer=True) for each in root.sets]
        root.sets = []
    candidates = [*pieces, *outside, root]
    pieces = [each for each in candidates if each.mesh.elements] or [each for each in candidates if each.mesh.others]
    size = sum(len(each.mesh.nodes) + len(each.mesh.elements) for each in pieces)
    if size > MAX_SIZE:
        raise MeshError(f"{path}: the instances have {size} nodes and elements, more than {MAX_SIZE}.")
    with_surface = [each for each in pieces if each.mesh.has_surface()]
    meant = with_surface or pieces
    naming = Naming(
        main=len(meant) == 1,
        outer_sets=[block for each in outside for block in each.sets],
        outer_surfaces=[surface for each in outside for surface in each.surfaces],
        instances=tuple(each.name.upper() for each in instances),
    )
    contents = joined(
        [
            piece_contents(
                path,
                each if each.kind != "ASSEMBLY" else replace(each, name="", sets=[], surfaces=[]),
                naming if each in meant else replace(naming, main=False),
                keep_apart=bool(with_surface) and _is_apart(each, root),
            )
            for each in pieces
        ]
    )
    if len(with_surface) > 1 and not instances:
        names = ", ".join(f"{path.name}#{each.name}" for each in with_surface if each.name)
        contents.needs_selection = (
            f"{path}: {len(with_surface)} parts have surface elements and no assembly places them; select one: {names}."
        )
    return contents


def _is_apart(piece: Container, root: Container) -> bool:
    """Return whether the rigid elements of a piece are another body than its deformable elements.

    meshio writes triangles as rigid elements in a file without parts, and no ``*RIGID BODY``.
    """
    return (piece.kind in ("PART", "INSTANCE") or root.has_rigid_body) and not piece.mesh.is_attached()


def _with_part(instance: Container, containers: list[Container]) -> Container:
    """Return an instance with the nodes, elements, sets and surfaces of its part beside its own."""
    if not instance.part:
        return instance
    parts = [each for each in containers if each.kind == "PART" and each.name.upper() == instance.part.upper()]
    if not parts:
        assert instance.line is not None
        raise instance.line.error(f"the part {instance.part!r} of the instance is not in the file.")
    (part,) = parts
    return replace(
        instance,
        mesh=part.mesh.with_more(instance.mesh),
        sets=part.sets + instance.sets,
        surfaces=part.surfaces + instance.surfaces,
    )


def _read_containers(path: Path) -> list[Container]:
    """Return the file outside of all parts, and the parts, instances and assemblies."""
    containers = [Container()]
    open_ = [containers[0]]
    for block in read_blocks(path):
        keyword, current = block.keyword, open_[-1]
        if keyword in ("PART", "INSTANCE", "ASSEMBLY"):
            open_ = [*open_, _opened(block, containers)]
            containers.append(open_[-1])
        elif keyword in ("ENDPART", "ENDINSTANCE", "ENDASSEMBLY"):
            while len(open_) > 1 and open_.pop().kind != keyword.removeprefix("END"):
                pass
        elif keyword in ("NSET", "ELSET"):
            current.sets.append(read_set(block, current.kind == "ASSEMBLY"))
        elif keyword == "SURFACE":
            surface = read_surface(block, current.kind == "ASSEMBLY")
            current.surfaces += [surface] if surface else []
        elif keyword == "RIGIDBODY":
            containers[0].has_rigid_body = True
        elif keyword in _COMMANDS:
            _COMMANDS[keyword](current, block)
    unfinished = open_[-1]
    if unfinished.line is not None:
        raise unfinished.line.error(f"*{unfinished.kind} has no *END {unfinished.kind}; the file is truncated.")
    return containers


def _opened(block: Block, containers: list[Container]) -> Container:
    """Return the container that a keyword opens."""
    kind, parameters = block.keyword, block.parameters
    name = parameters.get("NAME", "")
    if kind != "ASSEMBLY" and not name:
        raise block.line.error(f"*{kind} needs a name: *{kind}, NAME=name.")
    if any(each.kind == kind and each.name.upper() == name.upper() for each in containers):
        raise block.line.error(f"the {kind.lower()} {name!r} is defined a second time; rename one of the two.")
    for parameter in ("INSTANCE", "LIBRARY"):
        if parameter in parameters:
            raise block.line.error(f"*INSTANCE, {parameter}= takes the mesh from another analysis; export it as it is.")
    opened = Container(kind, name, parameters.get("PART", ""), block.line, budget=containers[0].budget)
    if kind == "INSTANCE":
        for line in block.data:
            with line.reported(f"*{kind}"):
                opened.placement.append((line, [real(item) if item else 0.0 for item in line.items()]))
    return opened
