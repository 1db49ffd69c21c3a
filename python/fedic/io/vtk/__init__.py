"""Mesh files of VTK: ``.vtu``, ``.vtp`` and ``.vtk``."""

from fedic.io.vtk._legacy import read_legacy_vtk
from fedic.io.vtk._xml import read_xml_vtk

__all__ = ["read_legacy_vtk", "read_xml_vtk"]
