"""Mesh generation."""

from fedic.meshing._gmsh import unstructured_mesh

__all__ = ["unstructured_mesh"]
