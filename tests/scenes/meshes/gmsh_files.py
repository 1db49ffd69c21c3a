"""Files of Gmsh, written by Gmsh."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

__all__ = ["OPTIONS", "write_plate", "write_second_order", "write_solid", "write_third_order", "write_version_1"]

OPTIONS: dict[str, dict[str, float]] = {
    "groups": {},
    "all entities (SaveAll)": {"SaveAll": 1},
    "parametric nodes": {"SaveParametric": 1},
    "partitioned": {"partitions": 2},
}


@contextmanager
def _session(options: Mapping[str, float]) -> Iterator[Any]:
    import gmsh

    gmsh.initialize([], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for name, value in options.items():
            gmsh.option.setNumber(f"Mesh.{name}", value)
        yield gmsh
    finally:
        gmsh.finalize()


def _mesh_rectangle(gmsh: Any) -> int:
    """Mesh a rectangle of 3 x 2 by 6 quads."""
    surface: int = gmsh.model.occ.addRectangle(0, 0, 0, 3, 2)
    gmsh.model.occ.synchronize()
    for _, line in gmsh.model.getEntities(1):
        x0, _, _, x1, _, _ = gmsh.model.getBoundingBox(1, line)
        gmsh.model.mesh.setTransfiniteCurve(line, 4 if x1 - x0 > 1.0 else 3)
    gmsh.model.mesh.setTransfiniteSurface(surface)
    gmsh.model.mesh.setRecombine(2, surface)
    return surface


def write_plate(path: Path, version: float, binary: bool, options: Mapping[str, float]) -> None:
    """Write a surface that is in two physical groups, and a line that is in one."""
    with _session({"MshFileVersion": version, "Binary": binary}) as gmsh:
        surface = _mesh_rectangle(gmsh)
        gmsh.model.addPhysicalGroup(2, [surface], 7, "plate")
        gmsh.model.addPhysicalGroup(2, [surface], 8, "also")
        gmsh.model.addPhysicalGroup(1, [1], 7, "bottom")
        gmsh.model.mesh.generate(2)
        for name, value in options.items():
            if name == "partitions":
                gmsh.model.mesh.partition(int(value))
            else:
                gmsh.option.setNumber(f"Mesh.{name}", value)
        gmsh.write(str(path))


def write_second_order(path: Path) -> None:
    with _session({"MshFileVersion": 2.2, "ElementOrder": 2}) as gmsh:
        gmsh.model.addPhysicalGroup(2, [_mesh_rectangle(gmsh)], 7, "plate")
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))


def write_third_order(path: Path) -> None:
    with _session({"MshFileVersion": 4.1, "ElementOrder": 3}) as gmsh:
        _mesh_rectangle(gmsh)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))


def write_solid(
    path: Path, element_order: int = 1, incomplete: bool = False, groups: bool = True, partitions: int = 0
) -> None:
    """Write a plate of hexahedra; without groups the file holds no surface cells, with partitions it holds all."""
    with _session({"ElementOrder": element_order, "SecondOrderIncomplete": incomplete}) as gmsh:
        surface = _mesh_rectangle(gmsh)
        (_, top), (_, volume), *_ = gmsh.model.occ.extrude([(2, surface)], 0, 0, 1, numElements=[2], recombine=True)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [volume], 1, "solid")
        if groups:
            gmsh.model.addPhysicalGroup(2, [top], 5, "TOP")
        gmsh.model.mesh.generate(3)
        if partitions:
            gmsh.model.mesh.partition(partitions)
            gmsh.option.setNumber("Mesh.SaveAll", 1)
        gmsh.write(str(path))


def write_version_1(path: Path) -> None:
    with _session({"MshFileVersion": 1.0}) as gmsh:
        _mesh_rectangle(gmsh)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
