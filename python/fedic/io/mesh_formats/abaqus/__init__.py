"""Mesh files of Abaqus."""

from fedic.io.mesh_formats.abaqus.reader import read_abaqus
from fedic.io.mesh_formats.abaqus.writer import write_abaqus

__all__ = ["read_abaqus", "write_abaqus"]
