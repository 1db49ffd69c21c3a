"""Mesh files of Nastran and OptiStruct."""

from fedic.io.mesh_formats.nastran.reader import read_nastran

__all__ = ["read_nastran"]
