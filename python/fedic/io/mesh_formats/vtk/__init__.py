"""Mesh files of VTK: ``.vtu``, ``.vtp`` and ``.vtk``."""

from fedic.io.mesh_formats.vtk._legacy import read_legacy_vtk
from fedic.io.mesh_formats.vtk._writer import write_vtu
from fedic.io.mesh_formats.vtk._xml import read_xml_vtk

__all__ = ["read_legacy_vtk", "read_xml_vtk", "write_vtu"]
