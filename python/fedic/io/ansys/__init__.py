"""Mesh files of Ansys (MAPDL)."""

from fedic.io.ansys.reader import read_ansys

__all__ = ["read_ansys"]
