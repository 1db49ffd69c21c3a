"""Mesh files of Gmsh, in all variants of versions 2.2, 4.0 and 4.1 of its format."""

from fedic.io.mesh_formats.msh._reader import read_msh

__all__ = ["read_msh"]
