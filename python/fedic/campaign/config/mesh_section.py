"""The section ``[mesh]`` of a configuration file."""

from typing import Annotated, TypeAlias

from pydantic import AfterValidator, Field, model_validator

from fedic._core import CELL_TYPES, Mesh, rectangle_mesh
from fedic._internal.sections import InFolder, Positive, Real, Section
from fedic.io.meshes import read_mesh
from fedic.meshing import unstructured_mesh

__all__ = ["MeshSection", "RectangleSection", "UnstructuredSection"]


def _cell(name: str) -> str:
    if name not in CELL_TYPES:
        raise ValueError(f"should be one of {', '.join(map(repr, CELL_TYPES))}")
    return name


Cell: TypeAlias = Annotated[str, AfterValidator(_cell)]
Polygon: TypeAlias = Annotated[list[tuple[Real, Real]], Field(min_length=3)]


class RectangleSection(Section):
    """``[mesh.rectangle]``: a regular mesh."""

    bounds: tuple[Real, Real, Real, Real]
    size: Positive
    cell: Cell = "quad"


class UnstructuredSection(Section):
    """``[mesh.unstructured]``: a polygon with holes, meshed by Gmsh."""

    outline: Polygon
    holes: list[Polygon] = Field(default_factory=list)
    size: Positive
    cell: Cell = "triangle"


class MeshSection(Section):
    """``[mesh]``: a file, or one of the two generators, and the unit of length."""

    file: InFolder | None = None
    rectangle: RectangleSection | None = None
    unstructured: UnstructuredSection | None = None
    unit: str | None = None

    @model_validator(mode="after")
    def _one_source(self) -> "MeshSection":
        if len(self.model_fields_set - {"unit"}) != 1:
            raise ValueError("should hold exactly one of mesh.file, [mesh.rectangle] and [mesh.unstructured]")
        return self

    def build(self) -> Mesh:
        """Read or make the mesh."""
        if self.file is not None:
            return read_mesh(self.file)
        if self.rectangle is not None:
            return rectangle_mesh(self.rectangle.bounds, size=self.rectangle.size, cell=self.rectangle.cell)
        assert self.unstructured is not None
        plan = self.unstructured
        return unstructured_mesh(plan.outline, size=plan.size, cell=plan.cell, holes=plan.holes)
