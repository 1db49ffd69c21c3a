"""Mesh files of Ansys (MAPDL)."""

from fedic.io.mesh_formats.ansys.reader import read_ansys

__all__ = ["read_ansys"]
